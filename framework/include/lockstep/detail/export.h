// SPDX-License-Identifier: BSD-3-Clause
// The export macro, and the compile settings that client and library must share.
#pragma once

#include <cstddef>

#include <Eigen/Core>

// Exports a symbol of the shared library to programs and plugins; symbols without it are hidden.
#if defined(__GNUC__)
#define LOCKSTEP_API __attribute__((visibility("default")))
#else
#define LOCKSTEP_API
#endif

// The settings that client and library must share, as symbols. Each file that includes this header refers to the
// symbols of the settings it was compiled with, and the library defines only those it was built with. A client with
// other settings fails to link, and the linker names the setting: undefined reference to
// `void lockstep::built_with::eigen_max_align_bytes<32>()'.
//
// Eigen's defaults depend on -march; the CMake target lockstep::lockstep and pkg-config fix them for every client.
// EIGEN_MAX_ALIGN_BYTES decides the alignment of fixed-size members, EIGEN_MALLOC_ALREADY_ALIGNED=0 how memory is
// allocated, so that a matrix that one side allocates can be resized by the other (Eigen's default changes with -mavx
// and -fsanitize=address).
#if defined(_GLIBCXX_DEBUG)
#define LOCKSTEP_CHECKED_CONTAINERS 1
#else
#define LOCKSTEP_CHECKED_CONTAINERS 0
#endif

namespace lockstep::built_with {

template <int bytes>
LOCKSTEP_API void eigen_max_align_bytes();
template <int bytes>
LOCKSTEP_API void eigen_max_static_align_bytes();
template <int yes>
LOCKSTEP_API void eigen_malloc_already_aligned();
template <int world, int major, int minor>
LOCKSTEP_API void eigen_version();
template <int yes>
LOCKSTEP_API void glibcxx_debug();  // -D_GLIBCXX_DEBUG changes the size of containers

#if !defined(lockstep_EXPORTS)  // the library need not compare itself with itself
// Refers to the symbols above; never read and never called. Every file has its own, so that no file's settings go
// unchecked. Costs 40 bytes per file.
#if defined(__has_cpp_attribute) && __has_cpp_attribute(gnu::retain)
[[gnu::retain]]
#endif
[[gnu::used]] static void (*const kSettings[])() = {
    &eigen_max_align_bytes<EIGEN_MAX_ALIGN_BYTES>, &eigen_max_static_align_bytes<EIGEN_MAX_STATIC_ALIGN_BYTES>,
    &eigen_malloc_already_aligned<EIGEN_MALLOC_ALREADY_ALIGNED>,
    &eigen_version<EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION>,
    &glibcxx_debug<LOCKSTEP_CHECKED_CONTAINERS>};
#endif

}  // namespace lockstep::built_with

// Whether the compiler adds the checks of a sanitizer: loaders pick variants before these can run. GCC defines a macro
// for each, Clang has a feature.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LOCKSTEP_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define LOCKSTEP_SANITIZED 1
#endif
#endif

// Before a function whose callees (Eigen's) leave inlining to the compiler: all calls are inlined. Not with sanitizers,
// whose checks would make it a function of minutes of compiling.
#ifdef LOCKSTEP_SANITIZED
#define LOCKSTEP_FLAT
#else
#define LOCKSTEP_FLAT [[gnu::flatten]]
#endif

// Before a function that a cloned function calls in its loops: always inlined, so that it is compiled for the caller's
// instruction set.
#define LOCKSTEP_INLINE [[gnu::always_inline]] inline
