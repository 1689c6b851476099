# SPDX-License-Identifier: BSD-3-Clause
# The folders motionlaws/ and integrators/: parts of the library, or each a plugin that it loads by name.
foreach(folder motionlaws integrators)
  file(GLOB folder_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.cpp)
  if(LOCKSTEP_BUILTINS)
    list(FILTER folder_sources EXCLUDE REGEX "/register_plugin\\.cpp$")
    target_sources(lockstep_core PRIVATE ${folder_sources})
    add_library(lockstep_${folder} INTERFACE)
    target_link_libraries(lockstep_${folder} INTERFACE lockstep_core)
  else()
    add_library(lockstep_${folder} SHARED ${folder_sources})
    target_link_libraries(lockstep_${folder} PUBLIC lockstep_core PRIVATE lockstep_own)
    target_link_options(lockstep_${folder} PRIVATE
                        "LINKER:--version-script=${PROJECT_SOURCE_DIR}/framework/cmake/exports.map")
    set_target_properties(lockstep_${folder} PROPERTIES
      PREFIX "" SUFFIX ".so" OUTPUT_NAME ${folder} INSTALL_RPATH "$ORIGIN/../.."
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/plugins)
    set_property(GLOBAL APPEND PROPERTY lockstep_plugin_targets lockstep_${folder})
    add_dependencies(lockstep_program lockstep_${folder})
  endif()
  set_target_properties(lockstep_${folder} PROPERTIES EXPORT_NAME ${folder})
  add_library(lockstep::${folder} ALIAS lockstep_${folder})
endforeach()
