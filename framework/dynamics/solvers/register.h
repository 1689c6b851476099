// Puts the solvers of this room on their shelf.
#pragma once

#include <lockstep/export.h>

namespace lockstep {

class Registry;

LOCKSTEP_API void register_solvers(Registry&);

}  // namespace lockstep
