// SPDX-License-Identifier: BSD-3-Clause
// The passes, 4 lanes a register.
#define LOCKSTEP_SET fma
#define LOCKSTEP_WIDE 4
#if defined(__x86_64__)
#define LOCKSTEP_TARGET __attribute__((target("fma")))
#else
#define LOCKSTEP_TARGET
#endif
#include "framework/tools/batch/lane_all.h"
