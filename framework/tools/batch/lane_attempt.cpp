// SPDX-License-Identifier: BSD-3-Clause
// An attempt at a step in lanes: steps chosen, stages, errors, and the lanes that accept it.
#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/batch/lane_run.h"

namespace lockstep::lanes {

void LaneRun::choose_steps() {
  for (int l = 0; l < kLanes; ++l) {
    Lane& the = lanes_[l];
    h_[l] = 0;  // lanes that have ended do not move
    if (!the.going) continue;
    try {
      if (!the.rejected) the.target = the.clock.next_target(t_[l], task_.times.back(), kNever, 0, false);
      h_[l] = the.clock.step_towards(t_[l], the.target, the.largest);
    } catch (const Error&) {  // the scalar code reports it
      leave(l);
    }
    if (!the.rejected) the.asked = h_[l];
    the.lands = h_[l] == the.target.reach - t_[l];
  }
}

void LaneRun::combine_stages(const Weights& w, const double* y, double* out) {
  std::array<const double*, Weights::kMost> k{};
  for (std::size_t i = 0; i < w.n; ++i) k[i] = k_[w.stage[i]].data();
  batch_.passes().combine(batch_.n(), y, h_.data(), w.n, k.data(), w.w.data(), out);
}

// True in lanes where an evaluation failed.
Flags8 LaneRun::evaluate_stages() {
  Flags8 failed{};
  for (Lane& lane : lanes_) lane.stages = {};
  for (int i = first_done_ ? 1 : 0; i < tableau_.n_stages; ++i) {
    if (i > 0) combine_stages(a_[i], y_.data(), stage_.data());
    Numbers8 t = t_;
    for (int l = 0; l < kLanes; ++l) t[l] += tableau_.c[i] * h_[l];
    const Flags8 unmet = batch_.evaluate(i > 0 ? stage_.data() : y_.data(), t, k_[i].data());
    for (int l = 0; l < kLanes; ++l) failed[l] = failed[l] || unmet[l];
    for (int l = 0; i == 0 && l < kLanes; ++l)
      first_a_[l] = batch_.largest_a(l), first_alpha_[l] = batch_.largest_alpha(l), lanes_[l].first = {};
    for (int l = 0; batch_.watches() && l < kLanes; ++l)
      (i == 0 ? lanes_[l].first : lanes_[l].stages).add(batch_.n_small(l), batch_.smallest_pivot(l));
  }
  first_done_ = true;
  return failed;
}

// EmbeddedRungeKutta::estimate for eight copies: on the bodies of all at once, and on the states that control the step.
// Lanes in which a law fails at the end of the step have failed.
void LaneRun::estimate(Numbers8& error, Flags8& failed) {
  error.fill(0);
  if (fixed_) return;
  Numbers8 t1 = t_, e3{};
  for (int l = 0; l < kLanes; ++l) t1[l] += h_[l];
  std::array<Change, kLanes> change, by;
  const Flags8 lost = batch_.change_to(end_.data(), t1, h_, change);
  const Tolerance& tolerance = task_.options.tolerance;
  std::array<BodyWeights, kLanes> weights;
  for (int l = 0; l < kLanes; ++l) {
    failed[l] = failed[l] || lost[l];
    const double a = h_[l] * first_a_[l], alpha = h_[l] * first_alpha_[l];
    change[l].take(0, 0, a * a, alpha * alpha);
    weights[l] = weights_of(tolerance, change[l]);
  }
  const auto each = [&](const Weights& w, Numbers8& out) {
    combine_stages(w, nullptr, error_.data());
    batch_.weigh(error_.data(), by);
    for (int l = 0; l < kLanes; ++l) {
      double sum = by[l].x + by[l].r + by[l].v + by[l].w;
      out[l] = in_tolerances(by[l], weights[l]);
      for (std::size_t k = 0, i = kL * batch_.first_state() + l; k < batch_.n_controlled(); ++k, i += kL) {
        const double moved = std::max(std::abs(end_[i] - y_[i]), h_[l] * std::abs(k_[0][i]));
        out[l] = std::max(out[l], std::abs(error_[i]) / (tolerance.atol_x + kTiny + tolerance.relative * moved));
        sum += std::abs(error_[i]);
      }
      if (!std::isfinite(sum)) out[l] = HUGE_VAL;
    }
  };
  each(error_w_, error);
  if (!task_.scheme.second) return;
  each(second_w_, e3);
  for (int l = 0; l < kLanes; ++l) error[l] = combined_error(error[l], e3[l]);
}

void LaneRun::attempt() {
  Flags8 failed = evaluate_stages();
  combine_stages(b_, y_.data(), end_.data());
  Numbers8 error{};
  estimate(error, failed);
  Flags8 wanted{};
  Numbers8 t1 = t_;
  for (int l = 0; l < kLanes; ++l) {
    wanted[l] = lanes_[l].going && !failed[l] && error[l] <= 1;
    t1[l] += h_[l];
  }
  std::array<Landing, kLanes> landed;
  batch_.project(end_.data(), t1, wanted, landed);
  const bool projects = task_.options.stabilization.kind == Stabilization::Kind::project;
  for (int l = 0; l < batch_.size(); ++l) {
    if (!lanes_[l].going) continue;
    const Landing& end = landed[l];
    const bool on =
        !projects || (fixed_ ? end.converged : end_is_near(end.converged, end.before, batch_.system(l).length()));
    if (failed[l] || !end.velocities_met || (batch_.watches() && lanes_[l].near_singular()))
      leave(l);
    else if (!wanted[l])
      reject(l, lanes_[l].control.reject(error[l]));
    else
      on ? accept(l, error[l]) : reject(l, 0.5);
  }
  if (jumped_) batch_.start_from(y_.data(), t_);
  jumped_ = false;
}

}  // namespace lockstep::lanes
