# SPDX-License-Identifier: BSD-3-Clause
# How every target of this project is compiled, and where its files go.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
set(CMAKE_BUILD_RPATH_USE_ORIGIN ON)  # the build tree may be moved

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, Debug or RelWithDebInfo" FORCE)
endif()

if(NOT CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(LOCKSTEP_CCACHE ccache)
  mark_as_advanced(LOCKSTEP_CCACHE)
  if(LOCKSTEP_CCACHE)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${LOCKSTEP_CCACHE})
  endif()
endif()

# What every client has to share with the library (framework/include/lockstep/detail/export.h), whatever its -march: classes hold
# Eigen's fixed-size vectors on boundaries of 16 bytes, and memory of the others is freed alike on both sides.
set(lockstep_shared_settings EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=0)

# Linked privately by all our own targets, never exported. Products and sums are not fused, so that every machine
# and both compilers give the same digits. Packs are passed between inlined functions alone (psabi).
add_library(lockstep_own INTERFACE)
target_compile_options(lockstep_own INTERFACE
  -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wno-psabi
  "$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-array-bounds;-Wno-stringop-overflow>")  # g++ 12 warns of its own std::string
target_compile_definitions(lockstep_own INTERFACE BOOST_ALL_NO_LIB BOOST_DLL_USE_STD_FS)  # Boost from headers alone

# A matrix that finds no memory for its new size is empty. What clients compile is Eigen's own; the layout is the same.
target_compile_definitions(lockstep_own INTERFACE EIGEN_MATRIX_PLUGIN="framework/foundation/support/matrix_resize.inc")
target_include_directories(lockstep_own INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)

# g++ collects its garbage when its heap has doubled; with a larger one to begin with (in kB) templates compile by a tenth
# faster.
target_compile_options(lockstep_own INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)
