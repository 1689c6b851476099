// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/back_to_plane.h"

#include <algorithm>
#include <cmath>

#include "framework/foundation/math/limits.h"

namespace lockstep {
namespace {

// Moves a state that lies in the plane except for rounding exactly into it. `from`: in the plane. False: it lies
// outside.
bool put_into(Plane plane, const System& system, const State& from, State& state) {
  for (int k = 0; k < system.n_slots(); ++k) {
    Pose pose = state.slot_pose(k);
    const double height = from.slot_pose(k).x[plane.n];
    const Vec3 turn = 2 * pose.q.vec();
    if (std::abs(pose.x[plane.n] - height) > kNegligible * system.length() || std::abs(turn[plane.i()]) > kNegligible ||
        std::abs(turn[plane.j()]) > kNegligible)
      return false;
    pose.x[plane.n] = height;
    pose.q = normalized(Quat::from(pose.q.w, Vec3(pose.q.vec()[plane.n] * Vec3::Unit(plane.n))));
    state.set_slot_pose(k, pose);
  }
  return true;
}

VecX multipliers_of(const RowTable& rows, const RowTable& in_space, const VecX& lambda) {
  VecX own(rows.n_rows);
  for (const RowEntry& e : rows.entries) {
    const RowEntry& all = in_space.entries[in_space.entry_of_link[e.link]];
    for (int k = 0; k < e.m; ++k)
      own[e.first_row + static_cast<int>(k)] =
          lambda[all.first_row + (std::ranges::find(all.own, e.own[k]) - all.own.begin())];
  }
  return own;
}

}  // namespace

void measure_move(const System& system, const State& from, const State& to, EquilibriumReport& report) {
  report.largest_move = 0;
  for (int k = 0; k < system.n_slots(); ++k)
    if (const double move = (to.slot_pose(k).x - from.slot_pose(k).x).norm(); move > report.largest_move)
      report.largest_move = move, report.moved_most = system.body_of_slot(k).name;
}

void go_back_to_plane(Dynamics& dynamics, System::InSpace& look, const State& start, const std::vector<AtRest>& found) {
  if (!look.plane()) return;
  std::vector<RowTable> rows;
  for (const AtRest& each : found) {
    if (!put_into(look.plane(), dynamics.system(), start, each.state)) return look.stay();
    rows.push_back(dynamics.gather_rows(each.state).rows());
  }
  look.end();
  for (std::size_t i = 0; i < found.size(); ++i)
    found[i].report.lambda =
        multipliers_of(dynamics.gather_rows(found[i].state).rows(), rows[i], found[i].report.lambda);
}

}  // namespace lockstep
