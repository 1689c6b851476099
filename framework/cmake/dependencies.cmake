# SPDX-License-Identifier: BSD-3-Clause
# What lockstep is built on. gnuplot, which draws the charts, is looked for when one is drawn.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Boost 1.74 REQUIRED)
find_package(spdlog REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(NLopt QUIET NO_MODULE)
if(NOT NLopt_FOUND)
  message(STATUS "lockstep optimize is left out: NLopt was not found (Debian: libnlopt-dev)")
endif()
if(LOCKSTEP_BUILD_TESTS)
  find_package(Catch2 QUIET)
  if(NOT Catch2_FOUND)
    message(FATAL_ERROR "The tests need Catch2, version 2 or 3, which was not found. Install it (Debian: catch2), "
                        "or configure with -DLOCKSTEP_BUILD_TESTS=OFF.")
  endif()
endif()
