// SPDX-License-Identifier: BSD-3-Clause
// Errors of a step on the bodies, against what the step changes (framework/docs/solvers.md, section 7).
#pragma once

#include <algorithm>
#include <cmath>

#include <lockstep/author/stepping.h>

namespace lockstep {

/// Squares of what changes most of any slot: its position, m, orientation, rad, velocity and angular velocity.
struct Change {
  double x = 0, r = 0, v = 0, w = 0;
  void take(double dx, double dr, double dv, double dw) {
    x = std::max(x, dx), r = std::max(r, dr), v = std::max(v, dv), w = std::max(w, dw);
  }
};

/// Makes 0/0 zero, where nothing moves and there is no absolute tolerance.
inline constexpr double kTiny = 1e-300;

/// The weights of a step that changes the slots by this; not less than the rates at its start give.
inline BodyWeights weights_of(const Tolerance& tolerance, const Change& c) {
  const double atol = tolerance.atol_x + kTiny, rtol = tolerance.relative;
  return {atol + rtol * std::sqrt(c.x), atol + rtol * std::sqrt(c.r), atol + rtol * std::sqrt(c.v),
          atol + rtol * std::sqrt(c.w)};
}

/// The largest error in tolerances, 1 = just met.
inline double in_tolerances(const Change& error, const BodyWeights& weights) {
  return std::max({std::sqrt(error.x) / weights.x, std::sqrt(error.r) / weights.r, std::sqrt(error.v) / weights.v,
                   std::sqrt(error.w) / weights.w});
}

}  // namespace lockstep
