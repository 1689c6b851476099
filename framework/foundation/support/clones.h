// SPDX-License-Identifier: BSD-3-Clause
// Functions of inner loops that are compiled for several instruction sets.
#pragma once

#include <lockstep/detail/export.h>

// Before a function of the inner loop: the loader picks the variant for the machine. Everything the function calls in its
// loops must be LOCKSTEP_INLINE. CMake's LOCKSTEP_CLONES decides which variants there are in addition to that for any x86-64.
#if !defined(__x86_64__) || !defined(__linux__) || defined(LOCKSTEP_SANITIZED)
#define LOCKSTEP_CLONES
#elif defined(LOCKSTEP_CLONE)
#define LOCKSTEP_CLONES [[gnu::target_clones(LOCKSTEP_CLONE, "default")]]
#elif defined(LOCKSTEP_NO_CLONES)
#define LOCKSTEP_CLONES
#else
#define LOCKSTEP_CLONES [[gnu::target_clones("avx512f", "fma", "default")]]
#endif

// LOCKSTEP_CLONES for functions whose callees (Eigen's) leave inlining to the compiler: all calls are inlined. Clang
// cannot combine the two and compiles the plain function.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(LOCKSTEP_SANITIZED) && defined(__OPTIMIZE__)
#define LOCKSTEP_FLAT_CLONES LOCKSTEP_FLAT LOCKSTEP_CLONES
#else
#define LOCKSTEP_FLAT_CLONES
#endif
