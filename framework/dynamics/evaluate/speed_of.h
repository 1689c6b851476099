// SPDX-License-Identifier: BSD-3-Clause
// The speed of the fastest body.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include <lockstep/math.h>
#include <lockstep/state.h>

namespace lockstep {

/// By velocities in the bodies' own coordinates, rad/s; velocities are divided by the length L of the mechanism, m.
inline double speed_of(const VecX& v, double L) {
  double w2 = 0;
  for (Eigen::Index i = 0; i < v.size(); i += 6)
    w2 = std::max({w2, v.segment<3>(i).squaredNorm() / (L * L), v.segment<3>(i + 3).squaredNorm()});
  return std::sqrt(w2);
}

/// The same by the motions of the slots.
inline double speed_of(std::span<const Motion> motions, double L) {
  double w2 = 0;
  for (const Motion& O : motions) w2 = std::max({w2, O.v.squaredNorm() / (L * L), O.w.squaredNorm()});
  return std::sqrt(w2);
}

/// Of the body that rotates fastest, rad/s; by either. Velocities do not count against an infinite length.
template <class Velocities>
double fastest_turn(const Velocities& of) {
  return speed_of(of, HUGE_VAL);
}

}  // namespace lockstep
