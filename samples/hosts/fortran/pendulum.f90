! SPDX-License-Identifier: BSD-3-Clause
! A pendulum from Fortran: the run of a scene, and a column of its table as an array, without a copy.
program pendulum
  use, intrinsic :: iso_c_binding
  use lockstep
  implicit none
  character(1024) :: scene
  type(c_ptr) :: run, values
  real(c_double), pointer :: angle(:)
  integer(c_int) :: index, right
  integer(c_int64_t) :: rows
  integer :: i

  scene = 'samples/scenes/pendulum.json'
  if (command_argument_count() > 0) call get_command_argument(1, scene)
  call check(lockstep_open(c_null_ptr, trim(scene)//c_null_char, 'run.until=2 s'//c_null_char, run))
  call check(lockstep_run_to_end(run))
  call check(lockstep_column_index(run, 'hinge.rz'//c_null_char, index))
  call check(lockstep_values(run, index, values, rows))
  call c_f_pointer(values, angle, [rows])
  do i = 1, size(angle), 10
    print '(f10.6)', angle(i)
  end do
  call check(lockstep_verdict(run, right))
  if (right /= 1 .or. rows /= 101 .or. abs(angle(1)) > 1d-12 .or. minval(angle) < -acos(-1d0) - 1d-6) stop 1
  call check(lockstep_free(run))

contains

  subroutine check(code)
    integer(c_int), intent(in) :: code
    if (code == 0) return
    print *, error_of(run)
    stop 1
  end subroutine

end program
