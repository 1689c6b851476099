# SPDX-License-Identifier: BSD-3-Clause
# Writes which commit a clean tree is at into a source of the program; "" for any other tree. Run at every build.
# Words: -D root=... -D file=...
cmake_minimum_required(VERSION 3.25)
set(commit "")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} --no-optional-locks -C ${root} status --porcelain OUTPUT_VARIABLE changes RESULT_VARIABLE failed ERROR_QUIET)
  if(failed EQUAL 0 AND changes STREQUAL "")
    execute_process(COMMAND ${git} -C ${root} rev-parse --short=12 HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  endif()
endif()
file(CONFIGURE OUTPUT ${file} @ONLY CONTENT
"// Written at every build by framework/cmake/commit.cmake.
#include \"framework/tools/program/commands.h\"

namespace lockstep {

std::string_view commit_of_build() { return \"@commit@\"; }

}  // namespace lockstep
")
