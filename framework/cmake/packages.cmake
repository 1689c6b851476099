# SPDX-License-Identifier: BSD-3-Clause
# cpack -G DEB in the build tree: a package from each component of install.cmake and of the hosts. Each part can be replaced
# alone, and two versions of the library can stand side by side: it is named after its SOVERSION.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lockstep)
set(CPACK_PACKAGE_VENDOR lockstep)
set(LOCKSTEP_MAINTAINER "The authors of lockstep <lockstep@example.org>" CACHE STRING
    "Who answers for Debian packages that are made here: Name <address>")
set(CPACK_PACKAGE_CONTACT "${LOCKSTEP_MAINTAINER}")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL library development program plugins doc c)
if(TARGET lockstep_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)

set(library_package liblockstep${LOCKSTEP_ABI})
set(same "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${library_package})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblockstep-dev)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lockstep)
set(CPACK_DEBIAN_PLUGINS_PACKAGE_NAME lockstep-plugins)
set(CPACK_DEBIAN_DOC_PACKAGE_NAME lockstep-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "${library_package} ${same}, libeigen3-dev (>= 3.4~), libeigen3-dev (<< 3.5), libspdlog-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "cmake (>= 3.25), lockstep, lockstep-plugins")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "${library_package} ${same}")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "lockstep-doc, lockstep-plugins, gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PLUGINS_PACKAGE_DEPENDS "${library_package} ${same}")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lockstep)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
if(TARGET lockstep_python)
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${library_package} ${same}, python3-numpy, \
python3 (>= 3.${Python3_VERSION_MINOR}~), python3 (<< 3.${next_python})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, python3-scipy, lockstep")

set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "The package lockstep for Python: runs, analyses and sweeps with arrays of\nnumpy; laws, forces, joints and integrators of Python functions.")
set(CPACK_DEBIAN_C_PACKAGE_NAME liblockstep-c)
set(CPACK_DEBIAN_C_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_C_PACKAGE_DEPENDS "${library_package} ${same}")
set(CPACK_DEBIAN_C_PACKAGE_RECOMMENDS "lockstep")

set(CPACK_COMPONENT_C_DESCRIPTION
    "lockstep from C and from languages that call C: library, header, CMake\npackage and pkg-config file, with samples in C and Fortran.")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
    "The library itself, for programs and plugins that were built with it.")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Headers, CMake package and pkg-config file, for host programs and for\nplugins: joints, laws of motion, forces and integrators of your own.")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
    "The program lockstep, which runs, checks, charts and sweeps scenes in\nJSON; scenes to begin with.")
set(CPACK_COMPONENT_PLUGINS_DESCRIPTION
    "Joints, laws and integrators that the program and host programs load by name.")

set(CPACK_COMPONENT_DOC_DESCRIPTION "The pages: first steps, scenes, joints, laws, forces, hosts and plugins,\nthe theory; with their pictures.")

# What else the files need is read from them, where the tool for it is there.
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
mark_as_advanced(DPKG_SHLIBDEPS)
if(DPKG_SHLIBDEPS)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/lib ${PROJECT_BINARY_DIR}/plugins)
endif()
# Copyright, changelogs, compressed manual pages; and what tells ldconfig and other packages of the library.
string(TIMESTAMP CPACK_LOCKSTEP_DAY "%a, %d %b %Y %H:%M:%S +0000" UTC)
set(CPACK_LOCKSTEP_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/framework/cmake/debian_files.cmake)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
set(CPACK_DEBIAN_C_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/triggers)
include(CPack)
