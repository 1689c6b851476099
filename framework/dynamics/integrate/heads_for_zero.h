// Whether an indicator of singular positions heads for one. Internal to singular passages and to runs in lanes.
#pragma once

#include <cmath>

namespace lockstep {

/// Of the indicators of a step's stages the least and the largest. Beside a singular position the root s of the indicator
/// is in proportion to the distance, so that its change tells how far that is: s turn/change by angle, s/change by steps.
/// True where that is less than half a radian or two steps, twice as much where the stages are on the constraints
/// already (`stays`), or the least is below a hundredth of `limit`. `turn`: of the step, rad; 0: not known, true.
inline bool heads_for_zero(double least, double largest, double limit, double turn, bool stays) {
  constexpr double kAngle = 0.5, kSteps = 2, kDeep = 1e-2;
  if (!(turn > 0) || least < kDeep * limit) return true;
  const double s = std::sqrt(least), change = (stays ? 2 : 1) * (std::sqrt(largest) - s);
  return !(s * turn >= kAngle * change && s >= kSteps * change);
}

}  // namespace lockstep
