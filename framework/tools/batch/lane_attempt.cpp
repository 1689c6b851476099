// SPDX-License-Identifier: BSD-3-Clause
// An attempt at a step in lanes: steps chosen, stages, errors, and the lanes that accept it.
#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/batch/lane_run.h"

namespace lockstep::lanes {

void LaneRun::choose_steps() {
  for (std::size_t l = 0; l < kL; ++l) {
    Lane& the = lanes_[l];
    h_[l] = 0;  // lanes that have ended do not move
    if (!the.going) continue;
    double h = the.advised;
    if (task_.options.max_step > 0) h = std::min(h, task_.options.max_step);
    the.asked = h;
    h_[l] = the.schedule.step(t_[l], h, fixed_);
    the.lands = the.schedule.lands(t_[l], h_[l]);
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
    for (std::size_t l = 0; l < kL; ++l) t[l] += tableau_.c[i] * h_[l];
    const Flags8 unmet = batch_.evaluate(i > 0 ? stage_.data() : y_.data(), t, k_[i].data());
    for (std::size_t l = 0; l < kL; ++l) failed[l] = failed[l] || unmet[l];
    if (batch_.watches()) see_pivots(i == 0);
    for (std::size_t l = 0; i == 0 && l < kL; ++l)
      first_a_[l] = batch_.largest_a(l), first_alpha_[l] = batch_.largest_alpha(l);
  }
  first_done_ = true;
  return failed;
}

void LaneRun::see_pivots(bool first) {
  for (std::size_t l = 0; l < kL; ++l) {
    Lane& the = lanes_[l];
    if (first) the.first = {};
    (first ? the.first : the.stages).add(batch_.n_small(l), batch_.smallest_pivot(l));
  }
}

// Whether a stage of the attempt is near a singular position: there more pivots are small than elsewhere.
bool LaneRun::near_singular(int lane) {
  const Lane& the = lanes_[lane];
  return std::max(the.first.most, the.stages.most) > the.usual ||
         std::min(the.first.smallest, the.stages.smallest) < the.near_below;
}

double LaneRun::error_of(int lane) {
  batch_.get(lane, error_.data(), rate_error_);
  return lanes_[lane].norm.of(rate_error_, state_end_);
}

// EmbeddedRungeKutta::estimate for eight copies. Lanes in which a law fails at the end of the step have failed.
void LaneRun::estimate(Numbers8& error, Flags8& failed) {
  error.fill(0);
  if (fixed_) return;
  Numbers8 e3{};
  batch_.weighs_errors() ? estimate_together(error, e3, failed) : estimate_each(error, e3, failed);
  for (std::size_t l = 0; scheme_.second && l < kL; ++l) error[l] = combined_error(error[l], e3[l]);
}

// On the bodies of all copies at once.
void LaneRun::estimate_together(Numbers8& error, Numbers8& e3, Flags8& failed) {
  Numbers8 t1 = t_;
  for (std::size_t l = 0; l < kL; ++l) t1[l] += h_[l];
  std::array<Change, kLanes> change, by;
  const Flags8 lost = batch_.change_to(end_.data(), t1, h_, change);
  std::array<BodyWeights, kLanes> weights;
  for (std::size_t l = 0; l < kL; ++l) {
    failed[l] = failed[l] || lost[l];
    const double a = h_[l] * first_a_[l], alpha = h_[l] * first_alpha_[l];
    change[l].take(0, 0, a * a, alpha * alpha);
    weights[l] = weights_of(task_.options.tolerance, change[l]);
  }
  const auto each = [&](const Weights& w, Numbers8& out) {
    combine_stages(w, nullptr, error_.data());
    batch_.weigh(error_.data(), by);
    for (std::size_t l = 0; l < kL; ++l) {
      const double sum = by[l].x + by[l].r + by[l].v + by[l].w;
      out[l] = std::isfinite(sum) ? in_tolerances(by[l], weights[l]) : HUGE_VAL;
    }
  };
  each(error_w_, error);
  if (scheme_.second) each(second_w_, e3);
}

// Copy by copy, by ErrorNorm.
void LaneRun::estimate_each(Numbers8& error, Numbers8& e3, Flags8& failed) {
  const auto each = [&](const Weights& w, bool scale, Numbers8& out) {
    combine_stages(w, nullptr, error_.data());
    for (int l = 0; l < batch_.size(); ++l) {
      const auto i = static_cast<std::size_t>(l);
      Lane& the = lanes_[i];
      if (!the.going || failed[i]) continue;
      try {
        read(l, end_.data(), t_[i] + h_[i], state_end_);
        if (scale) {
          read(l, y_.data(), t_[i], state_);
          batch_.get(l, k_[0].data(), rate_);
          rate_.largest_a = first_a_[i], rate_.largest_alpha = first_alpha_[i];
          the.norm.scale(state_, rate_, h_[i], state_end_);
        }
        out[i] = error_of(l);
      } catch (const Error&) {
        failed[i] = true;
      }
    }
  };
  each(error_w_, true, error);
  if (scheme_.second) each(second_w_, false, e3);
}

void LaneRun::attempt() {
  Flags8 failed = evaluate_stages();
  combine_stages(b_, y_.data(), end_.data());
  Numbers8 error{};
  estimate(error, failed);
  Flags8 wanted{};
  for (std::size_t l = 0; l < kL; ++l) wanted[l] = lanes_[l].going && !failed[l] && error[l] <= 1;
  Numbers8 t1 = t_;
  for (std::size_t l = 0; l < kL; ++l) t1[l] += h_[l];
  std::array<Landing, kLanes> landed;
  batch_.project(end_.data(), t1, wanted, landed);
  for (int l = 0; l < batch_.size(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    if (!lanes_[i].going) continue;
    if (failed[i] || !landed[i].velocities_met || (batch_.watches() && near_singular(l))) {
      leave(l);
      continue;
    }
    if (!wanted[i]) {
      reject(l, lanes_[i].control.reject(error[i]));
      continue;
    }
    const bool on =
        task_.options.stabilization.kind != Stabilization::Kind::project ||
        (fixed_ ? landed[i].converged : end_is_near(landed[i].converged, landed[i].before, batch_.system(l).length()));
    on ? accept(l, error[i]) : reject(l, 0.5);
  }
  if (jumped_) batch_.start_from(y_.data(), t_);
  jumped_ = false;
}

}  // namespace lockstep::lanes
