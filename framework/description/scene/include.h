// Scenes within a scene.
#pragma once

#include <string>
#include <vector>

#include <lockstep/params.h>

namespace lockstep {

/// Replaces "include" of a scene by what the named scenes hold: their points, bodies, markers, links, forces and events
/// come before the scene's own, with a prefix before their names; their run settings stay out. `files`: those that are
/// being read, the scene's own last. Throws SceneError, FileError.
void expand_includes(Value& root, const std::vector<std::string>& files);

}  // namespace lockstep
