# SPDX-License-Identifier: BSD-3-Clause
# Headers that stood in lockstep/ until 0.1 are in lockstep/author/, lockstep/detail/ or in others; for one release the old
# paths lead there.
file(GLOB moved_headers RELATIVE ${PROJECT_SOURCE_DIR}/framework/include ${PROJECT_SOURCE_DIR}/framework/include/lockstep/author/*.h
     ${PROJECT_SOURCE_DIR}/framework/include/lockstep/detail/*.h)
set(old_headers)
function(lockstep_forward name header)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/lockstep/${name} CONTENT
"// Forwards to <${header}>, for one release.
#pragma once
#pragma message(\"<lockstep/${name}> is now <${header}>\")
#include <${header}>
")
  list(APPEND old_headers ${PROJECT_BINARY_DIR}/generated/lockstep/${name})
  set(old_headers ${old_headers} PARENT_SCOPE)
endfunction()
foreach(header IN LISTS moved_headers)
  cmake_path(GET header FILENAME name)
  lockstep_forward(${name} ${header})
endforeach()
lockstep_forward(uniqueness.h lockstep/analysis.h)
