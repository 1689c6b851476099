// SPDX-License-Identifier: BSD-3-Clause
// The passes, 8 lanes a register.
#define LOCKSTEP_SET avx512
#define LOCKSTEP_WIDE 8
#define LOCKSTEP_INSTRUCTIONS "avx512f"
#include "framework/tools/batch/lane_all.h"
