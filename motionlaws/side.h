// On which side of a jump an instant lies, and whether two pieces of law meet with one.
#pragma once

#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// Every law is continuous from the right: at a breakpoint it has the value that holds afterwards. Times are sums of
/// durations and delays, so an instant that is meant to be the breakpoint may miss it by a rounding error; whatever
/// lies within this share of the law's own duration before it counts as the breakpoint.
inline constexpr double kEarly = 1e-12;

/// The limit of `law` for t from below, extrapolated from two instants 1e-9 `span` apart (error: square of that).
LawValue left_limit(const MotionLaw& law, double t, double span);

/// Largest |y|, |yd|, |ydd| of `law` at a few instants of [t0, t0 + span): what a jump is measured by.
LawValue size_of(const MotionLaw& law, double t0, double span);

/// Whether two values differ by more than rounding at that size.
bool differs(const LawValue& a, const LawValue& b, const LawValue& size);

/// a + offset: the rates stay.
inline LawValue raised(LawValue a, double offset) {
  a.y += offset;
  return a;
}
inline LawValue held(double y) { return {y, 0.0, 0.0}; }

}  // namespace lockstep
