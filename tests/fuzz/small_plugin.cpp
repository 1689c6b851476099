// SPDX-License-Identifier: BSD-3-Clause
// A plugin with nothing in it: a seed for the target that reads files of plugins.
#include <lockstep/author/plugin.h>

LOCKSTEP_PLUGIN(registry) { static_cast<void>(registry); }
