// SPDX-License-Identifier: BSD-3-Clause
// Private to the room: sides of a jump.
#pragma once

#include <lockstep/author/law.h>

namespace lockstep {

// On which side of a jump an instant is, and whether two pieces of law meet with one.

/// Every law is continuous from the right: at a breakpoint it has the value that holds afterwards. Times are sums of
/// durations and delays, so an instant that is meant to be the breakpoint may miss it by a rounding error; an instant
/// that is before it by less than this share of the law's duration counts as the breakpoint.
inline constexpr double kEarly = 1e-12;

/// The limit of `law` for t from below, extrapolated from two instants that are 1e-9 `span` apart; t and span in s.
LawValue left_limit(const MotionLaw& law, double t, double span);

/// Largest |y|, |yd|, |ydd| of `law` at seven instants of [t0, t0 + span), s: the scale for differs().
LawValue size_of(const MotionLaw& law, double t0, double span);

/// Whether a and b differ by more than 1e-10 of `size` in y, yd or ydd.
bool differs(const LawValue& a, const LawValue& b, const LawValue& size);

/// Appends the breakpoints of `law` in (from, to) of its own time, which is 0 at `start`, s.
void append_breakpoints(const MotionLaw& law, double from, double to, double start, std::vector<double>& out);

/// a with the value raised by `offset`; the rates are the same.
inline LawValue raised(LawValue a, double offset) {
  a.y += offset;
  return a;
}
/// The value y at rest.
inline LawValue held(double y) { return {y, 0.0, 0.0}; }

}  // namespace lockstep
