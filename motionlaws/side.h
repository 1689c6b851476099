// SPDX-License-Identifier: BSD-3-Clause
// Private to the room: sides of a jump.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <lockstep/author/law.h>

namespace lockstep {

/// Every law is continuous from the right: at a breakpoint it has the value that holds afterwards. Times are sums of
/// durations and delays, so an instant that is meant to be the breakpoint may miss it by a rounding error; an instant
/// that is before it by less than this share of the law's duration counts as the breakpoint.
inline constexpr double kEarly = 1e-12;

/// A part of a law in its own time, which is 0 at `start`, s.
struct Part {
  const MotionLaw& law;
  double start, begin = -HUGE_VAL, end = HUGE_VAL;
};
/// Appends the breakpoints of a part in (t0, t1), to which rounding of the start adds none.
inline void append_breakpoints(const Part& part, double t0, double t1, std::vector<double>& out) {
  const double from = std::max(t0 - part.start, part.begin), to = std::min(t1 - part.start, part.end);
  if (!(from < to)) return;
  const auto before = static_cast<std::ptrdiff_t>(out.size());
  part.law.breakpoints(from, to, out);
  for (auto t = out.begin() + before; t != out.end(); ++t) *t += part.start;
  out.erase(std::remove_if(out.begin() + before, out.end(), [&](double t) { return !(t0 < t && t < t1); }), out.end());
}

/// a with the value raised by `offset`; the rates are the same.
inline LawValue raised(LawValue a, double offset) {
  a.y += offset;
  return a;
}
/// The value y at rest.
inline LawValue held(double y) { return {y, 0.0, 0.0}; }

}  // namespace lockstep
