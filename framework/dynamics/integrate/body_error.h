// Errors of a step on the bodies, against what the step changes (framework/docs/solvers.md, section 7).
#pragma once

#include <algorithm>
#include <cmath>

#include <lockstep/stepping.h>

namespace lockstep {

/// Squares of what changes most of any slot: its position, m, orientation, rad, velocity and angular velocity.
struct Change {
  double x = 0, r = 0, v = 0, w = 0;
  void take(double dx, double dr, double dv, double dw) {
    x = std::max(x, dx), r = std::max(r, dr), v = std::max(v, dv), w = std::max(w, dw);
  }
};

/// What an error is held against, for each of these.
struct BodyWeights {
  double x = 1, r = 1, v = 1, w = 1;
  BodyWeights() = default;
  /// Of a step that changes the slots by this; not less than the rates at its start give.
  BodyWeights(const Tolerance& tolerance, const Change& c) {
    constexpr double kTiny = 1e-300;  // makes 0/0 zero, where nothing moves and there is no absolute tolerance
    const double atol = tolerance.atol_x + kTiny, rtol = tolerance.relative;
    x = atol + rtol * std::sqrt(c.x), r = atol + rtol * std::sqrt(c.r);
    v = atol + rtol * std::sqrt(c.v), w = atol + rtol * std::sqrt(c.w);
  }
  /// The largest error in tolerances, 1 = just met.
  double of(const Change& error) const {
    return std::max({std::sqrt(error.x) / x, std::sqrt(error.r) / r, std::sqrt(error.v) / v, std::sqrt(error.w) / w});
  }
};

}  // namespace lockstep
