// A plugin that brings nothing.
#include <lockstep/plugin.h>

LOCKSTEP_PLUGIN(registry) { (void)registry; }
