// Body: a rigid body as description. It holds no motion: that is its slot's, in the State.
#pragma once

#include <string>

#include "framework/foundation/math/pose.h"
#include "framework/mechanism/model/inertia.h"

namespace lockstep {

/// What a body can do: turn as well (6 velocities), or only move (3, a particle).
enum class Freedoms { spatial, particle };

/// Slot of everything that never moves: no columns, no mass, no unknowns.
inline constexpr int kGround = -1;

struct Body {
  std::string name;
  MassProperties mass;
  Pose home;    ///< pose of the body's frame in the world at the start
  Twist start;  ///< v of the frame's origin, world; w in body axes
  Freedoms freedoms = Freedoms::spatial;
  bool fixed = false;

  int slot = kGround;  ///< set by System::setup
  Pose in_slot;        ///< pose of the body's frame in its slot (a slot's origin is its mass centre)
};

}  // namespace lockstep
