// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/history.h"

#include <algorithm>
#include <cmath>

#include "framework/mechanism/rows/loads.h"

namespace lockstep {
namespace {

VecX poses_of(const System& system, const State& state) {
  VecX poses(7 * static_cast<Eigen::Index>(system.bodies().size()));
  Eigen::Index k = 0;
  for (const Body& body : system.bodies()) {
    const Pose pose = body_pose(body, state);
    poses.segment<3>(k) = pose.x + rotation(pose.q) * body.mass.center;
    poses.segment<4>(k + 3) = pose.q.coefficients();
    k += 7;
  }
  return poses;
}

Quat rotation_of(const VecX& poses, Eigen::Index body) { return Quat::from(poses.segment<4>(7 * body + 3)); }

}  // namespace

void HistoryObserver::output(const Sample& s) {
  const double begin = cpu_();
  const long before = s.dynamics().work().evaluations;
  const State slots = s.dynamics().in_slots(s.state);
  Instant& now = to_.emplace_back(Instant{slots.t, energy_.value(s), kinetic_.value(s), poses_of(system_, slots),
                                          slots.v, VecX::Zero(slots.v.size())});
  const Evaluated& values = s.values();
  subtract_reactions(values.rows, values.lambda, now.load);
  evaluations_ += s.dynamics().work().evaluations - before;
  spent_ += cpu_() - begin;
}

HistoryError difference(const History& a, const History& b, double length) {
  HistoryError e;
  const auto take = [](double& most, double x) { most = std::isfinite(x) ? std::max(most, x) : HUGE_VAL; };
  if (a.size() != b.size()) return {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Instant &is = a[i], &other = b[i];
    for (Eigen::Index k = 0; k < is.poses.size() / 7; ++k) {
      take(e.position, (is.poses.segment<3>(7 * k) - other.poses.segment<3>(7 * k)).norm());
      const Quat between = conjugate(rotation_of(other.poses, k)) * rotation_of(is.poses, k);
      take(e.position, length * 2.0 * std::atan2(between.vec().norm(), std::abs(between.w)));
    }
    for (Eigen::Index k = 0; k < is.v.size() / 6; ++k) {
      take(e.velocity, (is.v.segment<3>(6 * k) - other.v.segment<3>(6 * k)).norm());
      take(e.velocity, length * (is.v.segment<3>(6 * k + 3) - other.v.segment<3>(6 * k + 3)).norm());
      take(e.reaction, (is.load.segment<3>(6 * k) - other.load.segment<3>(6 * k)).norm());
      take(e.reaction, (is.load.segment<3>(6 * k + 3) - other.load.segment<3>(6 * k + 3)).norm() / length);
    }
    take(e.energy, std::abs(is.energy - other.energy));
  }
  return e;
}

HistoryError size_of(const History& h, double length) {
  const VecX none = VecX::Zero(h.front().v.size());
  HistoryError size = difference(h, History(h.size(), {0, h.front().energy, 0, h.front().poses, none, none}), length);
  for (const Instant& now : h) size.energy = std::max(size.energy, now.kinetic);
  return size;
}

}  // namespace lockstep
