// What clients see of the library, and the settings that client and library must share.
#pragma once

#include <cstddef>

#include <Eigen/Core>

// Marks what the shared library shows to programs and plugins; everything else stays hidden.
#if defined(__GNUC__)
#define LOCKSTEP_API __attribute__((visibility("default")))
#else
#define LOCKSTEP_API
#endif

// The settings that client and library must share, as symbols: each file that includes this names those that it was
// compiled with, the library defines those that it was built with, so a client that differs does not link, and the
// linker says in what: undefined reference to `void lockstep::built_with::eigen_max_align_bytes<32>()'.
//
// Eigen's choices depend on -march; the CMake target lockstep::lockstep and pkg-config fix them for every client:
// EIGEN_MAX_ALIGN_BYTES is where fixed-size members stand in a class, EIGEN_MALLOC_ALREADY_ALIGNED=0 is how a matrix
// that one side resizes is freed by the other (left to Eigen, it would change with -mavx and -fsanitize=address).
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
LOCKSTEP_API void glibcxx_debug();  // -D_GLIBCXX_DEBUG: containers of another size

#if !defined(lockstep_EXPORTS)  // the library need not compare itself with itself
/// Never read, never called; one of its own for each file, so that none hides behind another. Costs 40 bytes a file.
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

// LOCKSTEP_CLONES: before a function of the inner loop. It is compiled for plain x86-64, for AVX with FMA and for
// AVX-512, and the loader takes the one that the machine runs. Everything it calls in its loops must be always_inline.
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define LOCKSTEP_CLONES [[gnu::target_clones("avx512f", "fma", "default")]]
#else
#define LOCKSTEP_CLONES
#endif

// The same for functions whose callees (Eigen's) leave the choice of inlining to the compiler: everything is drawn in.
// clang cannot combine the two and keeps the plain function.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && defined(__OPTIMIZE__)
#define LOCKSTEP_FLAT_CLONES [[gnu::flatten]] LOCKSTEP_CLONES
#else
#define LOCKSTEP_FLAT_CLONES
#endif

// Before what a cloned function calls in its loops: always drawn in, so that it is compiled for the caller's set.
#define LOCKSTEP_INLINE [[gnu::always_inline]] inline
