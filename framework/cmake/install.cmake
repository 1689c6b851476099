# SPDX-License-Identifier: BSD-3-Clause
# What a client includes is <lockstep/...>, here and installed alike.
# Components, which packages.cmake makes Debian packages of: library, development, program, plugins, doc, c, python.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/lockstep)
set(data_folder ${CMAKE_INSTALL_DATADIR}/lockstep)

install(TARGETS lockstep_core lockstep_scene lockstep_run lockstep_tools lockstep EXPORT lockstepTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development)
# Empty names, or the plugins without which the library has no laws and no integrators.
install(TARGETS lockstep_motionlaws lockstep_integrators EXPORT lockstepTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lockstep/plugins COMPONENT library)
if(TARGET lockstep_program)
  install(TARGETS lockstep_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
  install(TARGETS ${tool_programs} RUNTIME DESTINATION libexec/lockstep COMPONENT program)
endif()

install(DIRECTORY framework/include/lockstep DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development
        FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/generated/lockstep/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lockstep COMPONENT development)

install(DIRECTORY samples/scenes DESTINATION ${data_folder} COMPONENT program
        FILES_MATCHING PATTERN "*.json" PATTERN "*.csv")
# The samples name their scenes from the root of a clone: the documentation folder has the same paths.
cmake_path(RELATIVE_PATH CMAKE_INSTALL_FULL_DATADIR BASE_DIRECTORY ${CMAKE_INSTALL_FULL_DOCDIR}/samples OUTPUT_VARIABLE up)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/samples_link)
file(CREATE_LINK ${up}/lockstep/scenes ${PROJECT_BINARY_DIR}/samples_link/scenes SYMBOLIC)
install(FILES ${PROJECT_BINARY_DIR}/samples_link/scenes DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples COMPONENT program)
if(NOT CMAKE_CROSSCOMPILING)  # the program writes it when it is built
  install(FILES ${PROJECT_BINARY_DIR}/scene.schema.json DESTINATION ${data_folder} COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/lockstep.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/completions/lockstep
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
  install(FILES ${PROJECT_BINARY_DIR}/completions/_lockstep
          DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

# Pages and their pictures, in the folders of the source, so that links lead from one to the other.
foreach(page README.md framework/README.md framework/CHANGELOG.md framework/FROM_CHRONO.md framework/layout.txt framework/budgets.txt
             framework/mechanism/lock/THEORY.md plugins/README.md
             tests/benchmark/peers/README.md tests/benchmark/results/README.md tests/benchmark/results/peers.md)
  cmake_path(GET page PARENT_PATH folder)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT doc)
endforeach()
foreach(folder framework/docs tests/stability/maps tests/benchmark/results/amd-epyc)
  install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT doc
          FILES_MATCHING PATTERN "*.md" PATTERN "*.svg" PATTERN "*.png" PATTERN "*.webp" PATTERN "*_chart_*" EXCLUDE)
endforeach()

# What a user copies from: examples of plugins, and a host of them.
foreach(example bump cam_follower drag adams_bashforth)
  install(DIRECTORY plugins/${example} DESTINATION ${CMAKE_INSTALL_DOCDIR}/plugins COMPONENT development)
endforeach()
install(DIRECTORY samples/host_app DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples COMPONENT development)
install(DIRECTORY samples/hosts/c samples/hosts/fortran DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples/hosts COMPONENT c
        FILES_MATCHING PATTERN "*.c" PATTERN "*.f90")
if(TARGET lockstep_python)
  install(DIRECTORY samples/hosts/python DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples/hosts COMPONENT python
          FILES_MATCHING PATTERN "*.py" PATTERN "*.ipynb")
endif()

install(EXPORT lockstepTargets NAMESPACE lockstep:: DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(framework/cmake/lockstepConfig.cmake.in ${PROJECT_BINARY_DIR}/lockstepConfig.cmake
                              INSTALL_DESTINATION ${package_folder}
                              PATH_VARS CMAKE_INSTALL_BINDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lockstepConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lockstepConfig.cmake ${PROJECT_BINARY_DIR}/lockstepConfigVersion.cmake
              framework/cmake/lockstep_add_plugin.cmake
        DESTINATION ${package_folder} COMPONENT development)

# pkg-config, for clients without CMake. The prefix is found from the file's own place, so it may be moved.
set(lockstep_pc_flags ${lockstep_shared_settings})
list(TRANSFORM lockstep_pc_flags PREPEND "-D")
list(JOIN lockstep_pc_flags " " lockstep_pc_flags)
file(RELATIVE_PATH lockstep_pc_up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(framework/cmake/lockstep.pc.in ${PROJECT_BINARY_DIR}/lockstep.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/lockstep.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# lockstep from C: a package of its own, of C alone, for CMake and pkg-config.
set(c_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/lockstep-c)
get_target_property(lockstep_c_version lockstep_c VERSION)
get_target_property(LOCKSTEP_C_ABI lockstep_c SOVERSION)
install(TARGETS lockstep_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT c)
install(FILES framework/hosts/c/lockstep/c.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lockstep COMPONENT c)
configure_package_config_file(framework/hosts/c/lockstep-cConfig.cmake.in ${PROJECT_BINARY_DIR}/lockstep-cConfig.cmake
                              INSTALL_DESTINATION ${c_package_folder}
                              PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lockstep-cConfigVersion.cmake VERSION ${lockstep_c_version}
                                 COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lockstep-cConfig.cmake ${PROJECT_BINARY_DIR}/lockstep-cConfigVersion.cmake
        DESTINATION ${c_package_folder} COMPONENT c)
configure_file(framework/hosts/c/lockstep-c.pc.in ${PROJECT_BINARY_DIR}/lockstep-c.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/lockstep-c.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT c)
