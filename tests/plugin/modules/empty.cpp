// A plugin that brings nothing.
#include "framework/description/registry/plugin.h"

LOCKSTEP_PLUGIN(registry) { (void)registry; }
