# SPDX-License-Identifier: BSD-3-Clause
# How the parts of the library are built.

# Headers that most files of the core, of the tests and of the samples need are compiled once for each of the three; of
# other people's, these.
set(lockstep_common_headers <Eigen/Core> <algorithm> <array> <cmath> <functional> <map> <memory> <optional> <span> <string>
    <string_view> <unordered_map> <utility> <vector> <spdlog/fmt/fmt.h>)
set(lockstep_core_headers ${lockstep_common_headers} <lockstep/dynamics.h> <lockstep/step_loop.h> <lockstep/author/registry.h>)

option(LOCKSTEP_PRECOMPILE "Compile common headers once (OFF: every file brings its own, as tools that read one file want)" ON)
function(lockstep_precompile target)
  if(LOCKSTEP_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

# lockstep_share_precompiled(target owner): the precompiled headers of another target with the same settings, if it has any.
function(lockstep_share_precompiled target owner)
  if(LOCKSTEP_PRECOMPILE AND TARGET ${owner})
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

# Sources are compiled forty at once: most of a small file's time is its headers and the templates that it shares.
option(LOCKSTEP_UNITY "Compile sources in batches (OFF: one by one, as development and tools that read one file want)" ON)
function(lockstep_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${LOCKSTEP_UNITY} UNITY_BUILD_BATCH_SIZE 40)
endfunction()
set_source_files_properties(integrators/rk4.cpp integrators/dopri5.cpp integrators/dop853.cpp
                            framework/tools/charts/chart_grid.cpp
                            PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)  # their private names are those of a sibling

# Code that no inner loop calls is compiled quickly. The rest of the core is not: by -O2 its runs take a tenth longer.
function(lockstep_cold target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# lockstep_around_core(target): such code of our own, with one set of precompiled headers.
function(lockstep_around_core target)
  lockstep_cold(${target})
  target_compile_definitions(${target} PRIVATE lockstep_EXPORTS)
  lockstep_share_precompiled(${target} lockstep_setup)
endfunction()

# lockstep_setup: the rooms of the core in which nothing runs at every step. Its precompiled headers are those of all such
# code.
function(lockstep_setup_of_core)
  lockstep_cold(lockstep_setup)
  target_link_libraries(lockstep_setup PRIVATE lockstep_own Eigen3::Eigen spdlog::spdlog Boost::headers)
  target_compile_definitions(lockstep_setup PRIVATE lockstep_EXPORTS ${lockstep_shared_settings})
  target_include_directories(lockstep_setup PRIVATE $<TARGET_PROPERTY:lockstep_core,INCLUDE_DIRECTORIES>)
  lockstep_unity(lockstep_setup)
  lockstep_precompile(lockstep_setup ${lockstep_core_headers})
endfunction()

# lockstep_clones(source...): which variants of the functions marked in these files are compiled (support/clones.h). Native:
# for this machine and for any x86-64, which runs everywhere and is built in two thirds of the time. Packages take all.
set(LOCKSTEP_CLONES native CACHE STRING "Variants of inner loops beside that for any x86-64: native, or all")
set_property(CACHE LOCKSTEP_CLONES PROPERTY STRINGS native all)
function(lockstep_clones)
  set(words LOCKSTEP_NO_CLONES)
  if(LOCKSTEP_CLONES STREQUAL "all")
    return()
  elseif(EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
    if(flags MATCHES " avx512f( |$)")
      set(words LOCKSTEP_CLONE="avx512f")
    elseif(flags MATCHES " fma( |$)")
      set(words LOCKSTEP_CLONE="fma")
    endif()
  endif()
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_DEFINITIONS "${words}")
endfunction()

# lockstep_add_library(part file source...): the target lockstep_<part>, lockstep::<part> for clients, lib<file>.so.
function(lockstep_add_library part file)
  add_library(lockstep_${part} SHARED ${ARGN})
  add_library(lockstep::${part} ALIAS lockstep_${part})
  set_target_properties(lockstep_${part} PROPERTIES
    OUTPUT_NAME ${file} EXPORT_NAME ${part} VERSION ${PROJECT_VERSION} SOVERSION ${LOCKSTEP_ABI}
    DEFINE_SYMBOL lockstep_EXPORTS INSTALL_RPATH "$ORIGIN"
    LINK_DEPENDS ${PROJECT_SOURCE_DIR}/framework/cmake/exports.map)
  target_link_libraries(lockstep_${part} PRIVATE lockstep_own)
  target_link_options(lockstep_${part} PRIVATE
                      "LINKER:--version-script=${PROJECT_SOURCE_DIR}/framework/cmake/exports.map")
  lockstep_unity(lockstep_${part})
  if(part STREQUAL "core")
    lockstep_precompile(lockstep_core ${lockstep_core_headers})
  else()
    lockstep_around_core(lockstep_${part})
  endif()
endfunction()
