// The registry of everything that comes with lockstep.
#pragma once

#include "framework/plugin/registry.h"

namespace lockstep {

/// A fresh registry with all laws, links, forces, integrators and solvers of the library; their origin is "built in".
LOCKSTEP_API Registry builtin_registry();

}  // namespace lockstep
