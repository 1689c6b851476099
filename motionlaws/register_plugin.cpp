// SPDX-License-Identifier: BSD-3-Clause
// This folder as a plugin, if it is not part of the library (LOCKSTEP_BUILTINS=OFF).
#include <lockstep/author/plugin.h>
#include "framework/description/registry/builtins.h"

LOCKSTEP_PLUGIN(registry) { lockstep::register_motion_laws(registry); }
