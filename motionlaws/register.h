// SPDX-License-Identifier: BSD-3-Clause
// Registers the laws of this room.
#pragma once

#include <lockstep/detail/export.h>

namespace lockstep {

class Registry;

/// Adds the built-in scalar, translation and rotation laws. Throws PluginError when a name is taken.
LOCKSTEP_API void register_motion_laws(Registry&);

}  // namespace lockstep
