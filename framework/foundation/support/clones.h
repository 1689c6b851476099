// LOCKSTEP_CLONES: before a function of the inner loop. It is compiled for plain x86-64, for AVX with FMA and for
// AVX-512, and the loader takes the one that the machine runs. Everything it calls in its loops must be always_inline.
#pragma once

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
