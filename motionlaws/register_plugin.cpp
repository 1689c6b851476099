// This folder as a plugin, where it is no part of the library (LOCKSTEP_BUILTINS=OFF).
#include <lockstep/plugin.h>
#include "motionlaws/register.h"

LOCKSTEP_PLUGIN(registry) { lockstep::register_motion_laws(registry); }
