// The registry of everything that comes with lockstep.
#pragma once

#include "framework/description/registry/registry.h"

namespace lockstep {

/// A fresh registry with all laws, links, forces, integrators and solvers of the library; their origin is "built in".
/// A library that was built with LOCKSTEP_BUILTINS=OFF loads laws and integrators as plugins of these names, from
/// plugin_folders(); their origin is then "motionlaws" or "integrators". Throws PluginError when it cannot.
LOCKSTEP_API Registry builtin_registry();

}  // namespace lockstep
