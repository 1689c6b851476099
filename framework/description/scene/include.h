// Scenes within a scene.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/author/params.h>
#include "framework/description/scene/reading.h"

namespace lockstep {

/// Replaces "include" of a scene by what the named scenes hold: their points, bodies, markers, links, forces and events
/// come before the scene's own, with a prefix before their names, moved by the pose that is asked for. Each is
/// checked as if it stood alone; their run settings, gravity, "planar" and "merge" stay out. The formulas of the
/// included scenes are added to `formulas`, as in Scene. Throws SceneError, FileError, and what the rule throws.
void expand_includes(Value& root, SceneReading&, std::vector<std::pair<SourceLocation, std::string>>& formulas);

/// Warns of each key that the included scenes give, that changes how things move, and that the whole does not give.
void tell_left_out(const Value& root, const SceneReading&);

}  // namespace lockstep
