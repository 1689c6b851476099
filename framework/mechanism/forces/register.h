// Registers the built-in forces.
#pragma once

#include <lockstep/export.h>

namespace lockstep {
class Registry;
LOCKSTEP_API void register_forces(Registry&);
}  // namespace lockstep
