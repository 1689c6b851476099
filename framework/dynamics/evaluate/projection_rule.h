// SPDX-License-Identifier: BSD-3-Clause
// When the rounds of a projection end (framework/docs/solvers.md, section 6).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace lockstep {

/// The round-off of |C|, m, in a mechanism of this length and largest coordinate x_max.
inline double position_rounding(double length, double x_max) {
  return 1e-14 * length + 4 * std::numeric_limits<double>::epsilon() * x_max;
}

/// The round-off of |J v + Ct|, m/s, at this largest speed.
inline double velocity_rounding(double v_max) { return 8 * std::numeric_limits<double>::epsilon() * v_max; }

/// Rounds of the projection onto C = 0. They converge quadratically with a fresh factor, so three are usual.
class PositionRounds {
 public:
  /// Ends at |C| <= goal, m, or where C is rounding. It has converged if |C| is within the tolerance.
  PositionRounds(double goal, double tolerance) : goal_(goal), tolerance_(tolerance) {}

  /// Takes the residual |C| before the next round, and `are_met`, which tells whether C is rounding; true when no further
  /// round is needed.
  template <class Met>
  bool ends(double residual, Met&& are_met) {
    const double before = residual_;
    residual_ = residual;
    ++round_;
    chord_ = round_ > 0 && residual <= 0.1 * before;
    if (residual <= goal_ || are_met()) return true;
    if (round_ > 1 && residual > 0.5 * before && residual <= tolerance_) return true;  // round-off of this mechanism
    if (round_ < kMost && std::isfinite(residual)) return false;
    converged_ = residual <= tolerance_;
    return true;
  }
  int round() const { return round_; }
  double residual() const { return residual_; }
  /// Whether the last factor is good enough for the next round.
  bool chord() const { return chord_; }
  bool converged() const { return converged_; }

 private:
  static constexpr int kMost = 6;
  double goal_, tolerance_, residual_ = 0;
  int round_ = -1;
  bool chord_ = false, converged_ = true;
};

/// Of the length of the mechanism: a state that is nearer than this is on the constraints.
inline constexpr double kOnConstraints = 1e-7;

/// Rounds onto the velocities in joint coordinates: at most this many; a residual that is this small against the first is
/// met. A round with a factor of this position that leaves more than kStalledRows of the residual is the last.
inline constexpr int kTreeVelocityRounds = 8;
inline constexpr double kVelocitiesMet = 1e-3;
/// Rounds onto the velocities J v = -Ct, with one factor.
inline constexpr int kVelocityRounds = 3;
/// The goals of both for a tolerance of the violation, m and m/s.
inline double position_goal_of(double tolerance) { return 1e-2 * tolerance; }
inline double velocity_goal_of(double tolerance) { return 0.1 * position_goal_of(tolerance); }
}  // namespace lockstep
