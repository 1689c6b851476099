// SPDX-License-Identifier: BSD-3-Clause
// The passes, 2 lanes a register.
#define LOCKSTEP_SET plain
#define LOCKSTEP_WIDE 2
#include "framework/tools/batch/lane_all.h"
