# SPDX-License-Identifier: BSD-3-Clause
# lockstep_add_plugin(name source...): a module `plugins/<name>.so` in the build tree that lockstep can load by name.
# It serves the plugins of this repository and, through find_package(lockstep), everybody else's.
include_guard(GLOBAL)
include(GNUInstallDirs)

# A name that no library defines is an error of the link, not of the first run. Sanitizers leave their own to the program.
function(lockstep_refuse_undefined target)
  if(NOT "${CMAKE_CXX_FLAGS} ${CMAKE_MODULE_LINKER_FLAGS}" MATCHES "-fsanitize")
    target_link_options(${target} PRIVATE LINKER:-z,defs)
  endif()
endfunction()

function(lockstep_add_plugin name)
  if(NOT ARGN)
    message(FATAL_ERROR "lockstep_add_plugin(${name}): no source file; write lockstep_add_plugin(${name} ${name}.cpp)")
  endif()
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE lockstep::lockstep $<TARGET_NAME_IF_EXISTS:lockstep_own>)
  target_compile_options(${name} PRIVATE -ffp-contract=off)
  lockstep_refuse_undefined(${name})
  set_target_properties(${name} PROPERTIES
    PREFIX "" SUFFIX ".so" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON CXX_EXTENSIONS OFF
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/plugins
    INSTALL_RPATH "$ORIGIN/../..;$ORIGIN/../lib" INSTALL_RPATH_USE_LINK_PATH ON BUILD_WITH_INSTALL_RPATH ON)
  set_property(GLOBAL APPEND PROPERTY lockstep_plugin_targets ${name})
  install(TARGETS ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lockstep/plugins COMPONENT plugins)
endfunction()
