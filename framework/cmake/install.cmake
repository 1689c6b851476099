# Headers keep their paths, so an include line is the same here and in a client: #include "framework/lock/kernel.h".
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/lockstep)
set(data_folder ${CMAKE_INSTALL_DATADIR}/lockstep)

install(TARGETS lockstep EXPORT lockstepTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(TARGET lockstep_program)
  install(TARGETS lockstep_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

foreach(folder framework motionlaws integrators)
  if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/${folder})
    install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lockstep
            FILES_MATCHING PATTERN "*.h" PATTERN runner EXCLUDE PATTERN cmake EXCLUDE)
  endif()
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/generated/framework/version.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lockstep/framework)

if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/samples/scenes)
  install(DIRECTORY samples/scenes DESTINATION ${data_folder} FILES_MATCHING PATTERN "*.json" PATTERN "*.csv")
endif()
install(FILES framework/scene/scene.schema.json DESTINATION ${data_folder} OPTIONAL)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md framework/CHANGELOG.md framework/lock/THEORY.md DESTINATION ${CMAKE_INSTALL_DOCDIR} OPTIONAL)

install(EXPORT lockstepTargets NAMESPACE lockstep:: DESTINATION ${package_folder})
configure_package_config_file(framework/cmake/lockstepConfig.cmake.in ${PROJECT_BINARY_DIR}/lockstepConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lockstepConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lockstepConfig.cmake ${PROJECT_BINARY_DIR}/lockstepConfigVersion.cmake
              framework/cmake/lockstep_add_plugin.cmake
        DESTINATION ${package_folder})
