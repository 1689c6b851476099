// The object "run" of a scene.
#pragma once

#include <lockstep/scene.h>

namespace lockstep {

/// Settings as the scene says, defaults where it is silent (or null). Throws SceneError.
LOCKSTEP_API RunSettings read_run(const Value&);

}  // namespace lockstep
