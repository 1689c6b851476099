// Puts the built-in forces on a registry's shelf.
#pragma once

#include <lockstep/export.h>

namespace lockstep {
class Registry;
LOCKSTEP_API void register_forces(Registry&);
}  // namespace lockstep
