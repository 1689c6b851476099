// A plugin that brings nothing.
#include "framework/plugin/plugin.h"

LOCKSTEP_PLUGIN(registry) { (void)registry; }
