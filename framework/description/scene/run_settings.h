// The object "run" of a scene.
#pragma once

#include <lockstep/scene.h>

namespace lockstep {

/// The settings of a scene, with defaults for what it leaves out (or null). Throws SceneError.
LOCKSTEP_API RunSettings read_run(const Value&);

}  // namespace lockstep
