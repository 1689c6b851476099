// SPDX-License-Identifier: BSD-3-Clause
// The passes, 4 lanes a register.
#define LOCKSTEP_SET fma
#define LOCKSTEP_WIDE 4
#define LOCKSTEP_INSTRUCTIONS "fma"
#include "framework/tools/batch/lane_all.h"
