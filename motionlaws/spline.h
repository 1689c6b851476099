// Law 'spline'.
#pragma once

#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"
#include "motionlaws/spline_curve.h"

namespace lockstep {

/// Rates at clamped ends, the unit of y per s and per s^2 (the latter for the quintic only).
struct SplineEndValues {
  double start_rate = 0, end_rate = 0, start_acceleration = 0, end_acceleration = 0;
};

/// Piecewise polynomial y(t) through the points (t_i, y_i): cubic with continuous ydd, or quintic with continuous yddd
/// and ydddd. Outside of the points: refused by ModelError, held, or repeated (periodic ends). t in s, y in the unit of
/// the coordinate.
class LOCKSTEP_API Spline final : public MotionLaw {
 public:
  using Points = std::vector<std::pair<double, double>>;
  /// Throws ModelError: too few points, times that do not rise, numbers not finite, periodic ends that do not meet.
  explicit Spline(const Points& points, const SplineSettings& = {}, const SplineEndValues& = {});
  explicit Spline(SplineCurve curve) : curve_(std::move(curve)) {}
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  SplineCurve curve_;
};

namespace laws {
inline LawPtr<MotionLaw> spline(const Spline::Points& points, const SplineSettings& k = {},
                                const SplineEndValues& ends = {}) {
  return std::make_shared<const Spline>(points, k, ends);
}
}  // namespace laws

}  // namespace lockstep
