// SPDX-License-Identifier: BSD-3-Clause
// A plugin that brings nothing.
#include <lockstep/author/plugin.h>

LOCKSTEP_PLUGIN(registry) { (void)registry; }
