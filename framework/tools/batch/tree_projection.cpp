// SPDX-License-Identifier: BSD-3-Clause
// Projection of eight states in joint coordinates onto the rows that close their loops, by the rule of
// dynamics/evaluate/closure_projection.cpp for each copy; a copy that has converged waits for the others.
#include <algorithm>
#include <cmath>

#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/tree/closure_rows.h"
#include "framework/tools/batch/batch.h"

namespace lockstep::lanes {

namespace {

// Takes the residuals |C| before the next round: `going`, the lanes that need it. Returns whether the last factor is good
// enough for all of them, which share it.
bool next_round(const Numbers8& C, std::array<PositionRounds, kLanes>& rounds, Flags8& going,
                std::array<Landing, kLanes>& landed) {
  bool chord = true;
  for (int l = 0; l < kLanes; ++l) {
    if (!going[l]) continue;
    going[l] = !rounds[l].ends(C[l]);
    chord = chord && rounds[l].chord();
    if (rounds[l].round() == 0) landed[l].before = rounds[l].residual();
    landed[l].after = rounds[l].residual();
    landed[l].converged = rounds[l].converged();
  }
  return chord;
}

}  // namespace

void Batch::project(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed) {
  landed.fill({});
  normalize(y);
  if (closures_->empty()) return;
  if (stabilization_.kind != Stabilization::Kind::project) {
    gather(y, t);
    const Numbers8 C = closures_->norm_C();
    for (int l = 0; l < kLanes; ++l) landed[l].before = landed[l].after = C[l];
    return;
  }
  const bool chord = project_positions(y, t, wanted, landed);
  project_velocities(y, t, wanted, chord, landed);
  for (int l = 0; l < kLanes; ++l) landed[l].converged = landed[l].converged && !lost_[l];
  see_ends();
}

// C and Cd of the rows at these states.
void Batch::gather(const double* y, const Numbers8& t) {
  move(y, t, true);
  fill_closures(y, t);
  closures_->gather();
}

// Quaternions of balls get length one.
void Batch::normalize(double* y) const {
  for (const LaneNode& n : data_.plan.nodes) {
    if (n.turn != TreeTurn::ball) continue;
    for (int l = 0; l < kLanes; ++l) {
      double* e = y + kL * (n.q + static_cast<std::size_t>(n.n_slides)) + l;
      const double unit = 1.0 / std::sqrt(e[0] * e[0] + e[kL] * e[kL] + e[2 * kL] * e[2 * kL] + e[3 * kL] * e[3 * kL]);
      for (std::size_t i = 0; i < 4; ++i) e[kL * i] *= unit;
    }
  }
}

// q <- q (+) d
void Batch::advance(double* y, const double* d) const {
  for (const LaneNode& n : data_.plan.nodes) {
    const auto single = static_cast<std::size_t>(n.n_slides + (n.turn == TreeTurn::hinge ? 1 : 0));
    for (std::size_t i = 0; i < kL * single; ++i) y[kL * n.q + i] += d[kL * n.v + i];
    if (n.turn != TreeTurn::ball) continue;
    for (int l = 0; l < kLanes; ++l) {
      double* q = y + kL * (n.q + single) + l;
      const double* u = d + kL * (n.v + single) + l;
      const Quat e = Quat{q[0], q[kL], q[2 * kL], q[3 * kL]} * exponential(Vec3(u[0], u[kL], u[2 * kL]));
      q[0] = e.w, q[kL] = e.x, q[2 * kL] = e.y, q[3 * kL] = e.z;
    }
  }
}

// Largest component of a vector of the slots in each lane; at: where it is in moving::.
Numbers8 Batch::largest_of(std::size_t at) const {
  Numbers8 out{};
  for (std::size_t k = 1; k <= data_.plan.nodes.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      for (int l = 0; l < kLanes; ++l)
        out[l] = std::max(out[l], std::abs(data_.z.moving[kL * (moving::size * k + at + i) + l]));
  return out;
}

// H d + (J T)' z = 0,  J T d = -C,  q <- q (+) d. True if the last factor can be used for the velocities.
bool Batch::project_positions(double* y, const Numbers8& t, const Flags8& wanted, std::array<Landing, kLanes>& landed) {
  const double tolerance = stabilization_.tolerance;
  gather(y, t);
  const Numbers8 x_max = largest_of(moving::x);
  std::array<PositionRounds, kLanes> rounds;
  for (int l = 0; l < kLanes; ++l) rounds[l] = {position_goal_of(tolerance), tolerance, system(l).length(), x_max[l]};
  Flags8 going = wanted;
  for (;; gather(y, t)) {
    const bool chord = next_round(closures_->norm_C(), rounds, going, landed);
    if (!any(going)) return chord;
    if (!chord) closures_->factor();
    advance(y, closures_->correct_C(going));
    normalize(y);
  }
}

// A factor of a position before serves while each round leaves a tenth at most; with one of this position the proximal
// term alone leaves something. Copies whose velocities are not met then continue alone.
void Batch::project_velocities(double* y, const Numbers8& t, const Flags8& wanted, bool factored,
                               std::array<Landing, kLanes>& landed) {
  const Numbers8 v_max = largest_of(moving::v), w_max = largest_of(moving::w), first = closures_->norm_Cd();
  Numbers8 left = first, goal;
  Flags8 going = wanted;
  for (int l = 0; l < kLanes; ++l) {
    goal[l] = velocity_goal(velocity_goal_of(stabilization_.tolerance), std::max(v_max[l], w_max[l]));
    going[l] = wanted[l] && !(left[l] <= goal[l]);
  }
  bool old = factored;
  for (int round = 0; any(going) && round < kTreeVelocityRounds; ++round) {
    if (!factored) closures_->factor(), factored = true;
    const double* dv = closures_->correct_Cd(going);
    for (std::size_t i = 0; i < kL * data_.plan.n_v; ++i) y[kL * data_.plan.n_q + i] += dv[i];
    const Flags8 lost = lost_;
    move(y, t, true);
    lost_ = lost;
    closures_->gather_rates();
    const Numbers8 last = left;
    left = closures_->norm_Cd();
    bool again = false;
    for (int l = 0; l < kLanes; ++l) {
      if (!going[l]) continue;
      const bool slow = old && !(left[l] <= 0.1 * last[l]);
      going[l] = !(left[l] <= goal[l]) && (old || left[l] < kStalledRows * last[l]);
      again = again || (going[l] && slow);
    }
    if (again) factored = old = false;
  }
  for (int l = 0; l < kLanes; ++l)
    landed[l].velocities_met = !wanted[l] || left[l] <= goal[l] || left[l] <= kVelocitiesMet * first[l];
}

}  // namespace lockstep::lanes
