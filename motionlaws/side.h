// SPDX-License-Identifier: BSD-3-Clause
// Private to the room: sides of a jump.
#pragma once

#include <cstddef>
#include <vector>

#include <lockstep/author/law.h>

namespace lockstep {

/// Every law is continuous from the right: at a breakpoint it has the value that holds afterwards. Times are sums of
/// durations and delays, so an instant that is meant to be the breakpoint may miss it by a rounding error; an instant
/// that is before it by less than this share of the law's duration counts as the breakpoint.
inline constexpr double kEarly = 1e-12;

/// Appends the breakpoints of `law` in (from, to) of its own time, which is 0 at `start`, s.
inline void append_breakpoints(const MotionLaw& law, double from, double to, double start, std::vector<double>& out) {
  std::size_t k = out.size();
  law.breakpoints(from, to, out);
  for (; k < out.size(); ++k) out[k] += start;
}

/// a with the value raised by `offset`; the rates are the same.
inline LawValue raised(LawValue a, double offset) {
  a.y += offset;
  return a;
}
/// The value y at rest.
inline LawValue held(double y) { return {y, 0.0, 0.0}; }

}  // namespace lockstep
