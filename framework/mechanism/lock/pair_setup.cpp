// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/lock/pair_setup.h"

#include <lockstep/error.h>

namespace lockstep {

void refuse_particles(const std::string& link, const std::string& rows, const Marker& p, const Marker& s) {
  for (const Marker* m : {&p, &s})
    if (m->body->freedoms == Freedoms::particle)
      throw ModelError(
          "joint '" + link + "' constrains rotations (" + rows + ") of '" + m->body->name +
          "', which is a particle and cannot rotate; give it an inertia, or use a joint that leaves rotations free");
}

Pose pose_at_start(const Marker& p, const Marker& s, const MarkerFrame& P, const MarkerFrame& S) {
  const auto in_world = [](const Marker& m, const MarkerMotion& k) {
    const Pose slot = m.body->slot == kGround ? Pose{} : m.body->home * inverse(m.body->in_slot);
    return slot * Pose{k.u, k.q};
  };
  return inverse(in_world(s, S.at(0.0))) * in_world(p, P.at(0.0));
}

}  // namespace lockstep
