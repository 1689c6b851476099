// Puts every law of this room on the registry's shelves.
#pragma once

#include <lockstep/export.h>

namespace lockstep {

class Registry;

/// Adds the built-in scalar, translation and rotation laws. Throws PluginError when a name is taken.
LOCKSTEP_API void register_motion_laws(Registry&);

}  // namespace lockstep
