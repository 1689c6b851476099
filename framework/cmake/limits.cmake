# SPDX-License-Identifier: BSD-3-Clause
# Time limits of tests: each has one, about twenty times what it takes in a release build and at least a minute. That is
# lockstep_limit; test cases that take longer than 5 s have theirs in tests/limits.cmake.in. With assertions a test takes
# longer, and with the checks of sanitizers longer still, so all limits are multiplied by LOCKSTEP_PATIENCE.
set(LOCKSTEP_PATIENCE "" CACHE STRING "What the time limits of tests are multiplied with (empty: 1, 5 or 20, by what is built)")
set(lockstep_patience "${LOCKSTEP_PATIENCE}")
if(lockstep_patience STREQUAL "")
  set(lockstep_patience 1)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    set(lockstep_patience 20)
  elseif(CMAKE_BUILD_TYPE STREQUAL "Debug")
    set(lockstep_patience 5)
  endif()
endif()
if(NOT lockstep_patience MATCHES "^[1-9][0-9]*$")
  message(FATAL_ERROR "LOCKSTEP_PATIENCE is \"${LOCKSTEP_PATIENCE}\"; give a whole number from 1 on")
endif()
math(EXPR lockstep_limit "60 * ${lockstep_patience}")

# lockstep_limit_tests(SECONDS TEST...): these tests of this folder have so many seconds in a release build.
function(lockstep_limit_tests seconds)
  math(EXPR limit "${seconds} * ${lockstep_patience}")
  set_tests_properties(${ARGN} PROPERTIES TIMEOUT ${limit})
endfunction()

# All tests of this folder that have no limit so far have the usual one. Test cases that ctest finds in programs have
# theirs by catch_discover_tests.
function(lockstep_limit_the_rest)
  get_property(tests DIRECTORY PROPERTY TESTS)
  foreach(test IN LISTS tests)
    get_test_property(${test} TIMEOUT limit)
    if(NOT limit)
      set_tests_properties(${test} PROPERTIES TIMEOUT ${lockstep_limit})
    endif()
  endforeach()
endfunction()
