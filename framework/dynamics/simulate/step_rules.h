// SPDX-License-Identifier: BSD-3-Clause
// How the step loop chooses the length of a step.
#pragma once

#include <algorithm>
#include <cmath>

namespace lockstep {

inline constexpr double kLongTurn = 1;  ///< rad in a step: the run warns of more

/// The shortest step, s, at t that is no round-off of t and of the length of the run.
inline double least_step(double t, double span) { return 1e-13 * std::max(std::abs(t), span); }

/// The next step when `left` remains and h is advised: all of it, or half of it rather than leave a sliver. A step
/// within `rounding` of all counts as all.
inline double step_within(double left, double h, double rounding) {
  if (h >= left - rounding) return left;
  return 2 * h > left ? 0.5 * left : h;
}

/// The step to advise after one of length `made`, when `before` was advised, `asked` was requested and the method now
/// proposes `next`: a step that was cut short is no reason to give up the longer one.
inline double advised_after(double before, double asked, double made, double next) {
  return asked < before && made >= asked ? std::max(before, next) : next;
}

}  // namespace lockstep
