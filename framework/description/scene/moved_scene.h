// Scenes somewhere else: what the pose of an included scene does to its things.
#pragma once

#include <lockstep/author/params.h>
#include <lockstep/math.h>

namespace lockstep {

/// Moves all that an included scene places in the world: x -> A x + d for points, A u for directions and velocities,
/// q -> q_A q for orientations; what is given in the axes of bodies, markers and links moves with these. Not what it
/// measures there: channels of events, and the values that they cross, stay in the world's axes. Nor vectors among the
/// keys of forces of plugins, of which nobody says what axes they are in. `scene`: its data, formulas and names of points
/// replaced by numbers. Throws SceneError for values that are not of their form, and for laws of components in world axes
/// where the pose turns.
void move_scene(Value& scene, const Pose& by);

}  // namespace lockstep
