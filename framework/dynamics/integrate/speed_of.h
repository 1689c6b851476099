// The speed of the fastest body, by velocities in the bodies' own coordinates.
#pragma once

#include <algorithm>
#include <cmath>

#include <lockstep/math.h>

namespace lockstep {

/// rad/s; velocities are divided by the length L of the mechanism, m.
inline double speed_of(const VecX& v, double L) {
  double w2 = 0;
  for (Eigen::Index i = 0; i < v.size(); i += 6)
    w2 = std::max({w2, v.segment<3>(i).squaredNorm() / (L * L), v.segment<3>(i + 3).squaredNorm()});
  return std::sqrt(w2);
}

}  // namespace lockstep
