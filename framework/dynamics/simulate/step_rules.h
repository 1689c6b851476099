// How the step loop and batch runs choose the length of a step.
#pragma once

#include <algorithm>

namespace lockstep {

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
