! SPDX-License-Identifier: BSD-3-Clause
! lockstep from Fortran: interfaces of some functions of <lockstep/c.h>, which describes them.
module lockstep
  use, intrinsic :: iso_c_binding
  implicit none
  private
  public :: lockstep_open, lockstep_run_to_end, lockstep_column_index, lockstep_values, lockstep_verdict, lockstep_free
  public :: error_of

  interface
    integer(c_int) function lockstep_open(registry, file, set, made) bind(c)
      import :: c_int, c_ptr, c_char
      type(c_ptr), value :: registry
      character(kind=c_char), intent(in) :: file(*), set(*)
      type(c_ptr), intent(out) :: made
    end function
    integer(c_int) function lockstep_run_to_end(run) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: run
    end function
    integer(c_int) function lockstep_column_index(run, name, index) bind(c)
      import :: c_int, c_ptr, c_char
      type(c_ptr), value :: run
      character(kind=c_char), intent(in) :: name(*)
      integer(c_int), intent(out) :: index
    end function
    integer(c_int) function lockstep_values(run, index, values, rows) bind(c)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: run
      integer(c_int), value :: index
      type(c_ptr), intent(out) :: values
      integer(c_int64_t), intent(out) :: rows
    end function
    integer(c_int) function lockstep_verdict(run, right) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: run
      integer(c_int), intent(out) :: right
    end function
    integer(c_int) function lockstep_free(handle) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: handle
    end function
    type(c_ptr) function lockstep_error_text(handle) bind(c)
      import :: c_ptr
      type(c_ptr), value :: handle
    end function
    integer(c_size_t) function strlen(text) bind(c)
      import :: c_size_t, c_ptr
      type(c_ptr), value :: text
    end function
  end interface

contains

  ! The error of a handle as text.
  function error_of(handle) result(words)
    type(c_ptr), intent(in) :: handle
    character(:), allocatable :: words
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: text
    integer :: i
    text = lockstep_error_text(handle)
    call c_f_pointer(text, letters, [strlen(text)])
    allocate (character(size(letters)) :: words)
    do i = 1, size(letters)
      words(i:i) = letters(i)
    end do
  end function

end module
