// SPDX-License-Identifier: BSD-3-Clause
// The passes, 8 lanes a register.
#define LOCKSTEP_SET avx512
#define LOCKSTEP_WIDE 8
#if defined(__x86_64__)
#define LOCKSTEP_TARGET __attribute__((target("avx512f")))
#else
#define LOCKSTEP_TARGET
#endif
#include "framework/tools/batch/lane_all.h"
