// SPDX-License-Identifier: BSD-3-Clause
#include "motionlaws/side.h"

#include <algorithm>
#include <cmath>

namespace lockstep {

LawValue left_limit(const MotionLaw& law, double t, double span) {
  const double d = 1e-9 * span;
  const LawValue near = law.at(t - d), far = law.at(t - 2 * d);
  const double ydd = 2 * near.ydd - far.ydd;
  return {near.y + d * near.yd, near.yd + d * near.ydd, ydd};
}

LawValue size_of(const MotionLaw& law, double t0, double span) {
  LawValue most;
  for (const double u : {0.0, 0.13, 0.29, 0.5, 0.71, 0.87, 0.999}) {
    const LawValue v = law.at(t0 + u * span);
    most.y = std::max(most.y, std::abs(v.y));
    most.yd = std::max(most.yd, std::abs(v.yd));
    most.ydd = std::max(most.ydd, std::abs(v.ydd));
  }
  return most;
}

void append_breakpoints(const MotionLaw& law, double from, double to, double start, std::vector<double>& out) {
  std::size_t k = out.size();
  law.breakpoints(from, to, out);
  for (; k < out.size(); ++k) out[k] += start;
}

bool differs(const LawValue& a, const LawValue& b, const LawValue& size) {
  constexpr double kNoise = 1e-10;
  return std::abs(a.y - b.y) > kNoise * size.y || std::abs(a.yd - b.yd) > kNoise * size.yd ||
         std::abs(a.ydd - b.ydd) > kNoise * size.ydd;
}

}  // namespace lockstep
