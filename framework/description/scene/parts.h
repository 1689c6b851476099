// SPDX-License-Identifier: BSD-3-Clause
// Parts of a scene: other scenes that it includes, their poses, and repeated parts.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/math.h>
#include <lockstep/author/params.h>
#include "framework/description/scene/reading.h"

namespace lockstep {

/// Replaces "include" of a scene by the contents of the named scenes: their points, bodies, markers, joints, forces and
/// events come before the scene's own, with a prefix before their names, moved by the given pose. Each is checked as a
/// scene by itself; their run settings, gravity, "planar" and "merge" are left out. The formulas of the
/// included scenes are added to `formulas`, as in Scene. Throws SceneError, FileError, and what the rule throws.
void expand_includes(Value& root, SceneReading&, std::vector<std::pair<SourceLocation, std::string>>& formulas);

/// Warns of each key that the included scenes give, that changes how things move, and that the whole does not give.
void tell_left_out(const Value& root, const SceneReading&);

/// Moves all that an included scene places in the world: x -> A x + d for points, A u for directions and velocities,
/// q -> q_A q for orientations; values in the axes of bodies, markers and joints move with these. Not moved are channels
/// of events, and the values that they cross, which stay in world axes; nor vectors among the keys of plugins' forces,
/// whose axes are not known. `scene`: its data, formulas and names of points replaced by numbers. Throws SceneError for
/// values that are not of their form, and for laws of components in world axes if the pose rotates.
void move_scene(Value& scene, const Pose& by);

/// Replaces "repeat" of the scene by its repetitions, at the ends of "points", "bodies", "markers", "links" and "forces".
/// In each, the index is a number in formulas, and "{i}", "{i+1}" in texts become integers. Throws SceneError.
void expand_repeats(Value& root);

}  // namespace lockstep
