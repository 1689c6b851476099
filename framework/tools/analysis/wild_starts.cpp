// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/wild_starts.h"

#include <algorithm>

#include "framework/dynamics/simulate/start_positions.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

void scatter(const System& system, double size, Draw& random, State& state) {
  const Plane plane = system.plane();
  for (int k = 0; k < system.n_slots(); ++k) {
    Pose pose = state.slot_pose(k);
    Vec3 move = random.vector(size), turn = random.vector(kPi);
    if (plane) {
      move[plane.n] = 0;
      turn = turn[plane.n] * Vec3::Unit(plane.n);
    }
    pose.x += move;
    if (system.slot(k).freedoms == Freedoms::spatial) pose.q = normalized(pose.q * exponential(turn));
    state.set_slot_pose(k, pose);
  }
}

bool fit(Dynamics& dynamics, State& state) {
  const double near = kRoundOff * std::max(1.0, dynamics.system().length());
  return solvable([&] { return approach_links(dynamics, state, near); });
}

double apart(const System& system, const State& a, const State& b, std::string* body) {
  double most = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Pose p = a.slot_pose(k), q = b.slot_pose(k);
    const double turn = system.slot(k).freedoms == Freedoms::spatial
                            ? rotation_vector(conjugate(normalized(p.q)) * normalized(q.q)).norm()
                            : 0.0;
    const double d = std::max((p.x - q.x).norm(), system.length() * turn);
    if (!(d > most)) continue;
    most = d;
    if (body != nullptr) *body = system.body_of_slot(k).name;
  }
  return most;
}

}  // namespace lockstep
