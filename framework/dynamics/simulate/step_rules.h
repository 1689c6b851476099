// The rules by which the step loop and the runs of a batch choose the length of a step.
#pragma once

#include <algorithm>

namespace lockstep {

/// The next step on the way `left` when h is advised: all of it, or half of it rather than leave a sliver; what is
/// within `rounding` counts as all.
inline double step_within(double left, double h, double rounding) {
  if (h >= left - rounding) return left;
  return 2 * h > left ? 0.5 * left : h;
}

/// The step to advise after one of `made` was asked for as `asked`, where `before` was advised, and `next` came out of
/// it: a step cut short says nothing against the longer one.
inline double advised_after(double before, double asked, double made, double next) {
  return asked < before && made >= asked ? std::max(before, next) : next;
}

}  // namespace lockstep
