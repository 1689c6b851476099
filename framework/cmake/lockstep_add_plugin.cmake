# lockstep_add_plugin(name source...): a module `plugins/<name>.so` in the build tree that lockstep can load by name.
# It serves the plugins of this repository and, through find_package(lockstep), everybody else's.
include_guard(GLOBAL)
include(GNUInstallDirs)

# lockstep_seal_plugin(target): writes a checksum into the module after each link, by which the loader knows a damaged
# file. It survives `strip`, not a changed run path: hence BUILD_WITH_INSTALL_RPATH.
function(lockstep_seal_plugin name)
  if(CMAKE_CROSSCOMPILING)
    return()  # the program is for another machine; an unsealed plugin is loaded too
  endif()
  foreach(program lockstep_program lockstep::program)  # of this tree, or installed
    if(TARGET ${program})
      add_custom_command(TARGET ${name} POST_BUILD VERBATIM
                         COMMAND ${program} plugins seal $<TARGET_FILE:${name}>)
      return()
    endif()
  endforeach()
endfunction()

function(lockstep_add_plugin name)
  if(NOT ARGN)
    message(FATAL_ERROR "lockstep_add_plugin(${name}): no source file; write lockstep_add_plugin(${name} ${name}.cpp)")
  endif()
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE lockstep::lockstep $<TARGET_NAME_IF_EXISTS:lockstep_own>)
  target_compile_options(${name} PRIVATE -ffp-contract=off)
  set_target_properties(${name} PROPERTIES
    PREFIX "" SUFFIX ".so" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON CXX_EXTENSIONS OFF
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/plugins
    INSTALL_RPATH "$ORIGIN/../..;$ORIGIN/../lib" INSTALL_RPATH_USE_LINK_PATH ON BUILD_WITH_INSTALL_RPATH ON)
  lockstep_seal_plugin(${name})
  set_property(GLOBAL APPEND PROPERTY lockstep_plugin_targets ${name})
  install(TARGETS ${name} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lockstep/plugins COMPONENT plugins)
endfunction()
