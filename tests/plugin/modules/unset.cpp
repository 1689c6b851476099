// SPDX-License-Identifier: BSD-3-Clause
// A plugin built without the flags that lockstep's target and lockstep.pc give.
#undef EIGEN_MALLOC_ALREADY_ALIGNED
#define EIGEN_MALLOC_ALREADY_ALIGNED 1
#include <lockstep/author/plugin.h>

LOCKSTEP_PLUGIN(registry) { registry.laws.set_origin(""); }
