// Scenes within a scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/params.h>

namespace lockstep {

/// Replaces "include" of a scene by what the named scenes hold: their points, bodies, markers, links, forces and events
/// come before the scene's own, with a prefix before their names, moved by the pose that is asked for; their run settings
/// and gravity stay out. `files`: those that are being read, the scene's own last. The formulas of the included scenes
/// are added to `formulas`, as in Scene. Throws SceneError, FileError.
void expand_includes(Value& root, const std::vector<std::string>& files,
                     std::vector<std::pair<Where, std::string>>& formulas);

}  // namespace lockstep
