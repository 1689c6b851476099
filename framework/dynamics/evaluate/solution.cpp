// SPDX-License-Identifier: BSD-3-Clause
// Accelerations and multipliers at a state, also in a singular position or close to it.
#include <lockstep/dynamics.h>

#include <algorithm>
#include <cmath>
#include <exception>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {

constexpr double kUseless = 1e-2;  // relative: a multiplier that is so uncertain is none

}  // namespace

SolveReport Solution::full_report() const {
  SolveReport full = report;
  factor.complete(evaluation, full);
  return full;
}

// What the position is off the constraints counts as its rounding does. In the position itself rows contradict one
// another, so that there may be limits but no solution.
const Solution& Dynamics::solution_at(const State& state) {
  std::exception_ptr refused;
  const auto evaluate_here = [&] {
    try {
      evaluate(state);
    } catch (const SolveError&) {
      refused = std::current_exception();
    }
  };
  evaluate_here();
  Solution& out = *solution_;
  const bool loops = own().layout()->loops;
  if (refused && !loops) std::rethrow_exception(refused);
  const double detector = refused ? 0 : loops ? std::max(out.full_report().detector, 0.0) : HUGE_VAL;
  if (!(detector < SingularRate::kDelta * SingularRate::kDelta)) return out;
  own().residuals(C_, Cd_);
  const double off = std::max(SingularRate::kPoseRoundOff, own().norm(C_) / system_.length());
  if (!(SingularRate::round_off(std::sqrt(detector), off) > kSlight)) return out;

  State here = state;
  to_slots(here);
  if (!both_sides_) both_sides_ = std::make_unique<SingularRate>();
  SingularRate& both = *both_sides_;
  both.begin(here);
  StateRate rate = sized_like(here);
  const WorkCount before = work_;
  const bool agree = both.find(*this, here, detector, rate) == SingularRate::Sides::agree;
  evaluate_here();  // the states near it are no work of the run, and leave their solution
  work_ = before;
  if (refused && !(agree && both.grows())) std::rethrow_exception(refused);
  const double direct = SingularRate::round_off(agree ? both.distance_by_sides() : both.distance(), off);
  const double limit = std::max(
      {both.error(), both.multiplier_error(), SingularRate::round_off(SingularRate::kDelta - both.distance())});
  out.uncertainty = direct < 1 ? direct : 1;
  if (!agree || !(limit < direct)) return out;
  a_ = rate.v;
  for (Eigen::Index k = 0; k < lambda_.size(); ++k) {
    const double found = both.multipliers()[k];
    if (!std::isnan(found) || !(direct < kUseless)) lambda_[k] = found;
  }
  if (!both.multipliers().hasNaN()) out.uncertainty = limit;
  return out;
}

}  // namespace lockstep
