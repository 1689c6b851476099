// Slot: what moves as one: a body, or several that are bolted together. Its origin is the common mass centre.
#pragma once

#include <vector>

#include "framework/mechanism/model/body.h"

namespace lockstep {

struct Slot {
  std::vector<Body*> bodies;  ///< the first gives it its name in messages
  double mass = 0;            ///< kg
  Mat3 J = Mat3::Zero();      ///< inertia about the origin, slot axes, kg m^2
  Pose home;                  ///< of the slot in the world at the start
  Freedoms freedoms = Freedoms::spatial;
};

}  // namespace lockstep
