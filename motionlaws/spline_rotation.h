// Rotation law 'spline_rotation'.
#pragma once

#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"
#include "motionlaws/spline_curve.h"

namespace lockstep {

/// q(t) = r(t)/|r(t)| through the orientations (t_i, q_i), r(t) a cubic or quintic spline of the four components.
///
/// Why this and not another: q and -q are one orientation, so the sign of each q_i is first made that of its
/// predecessor (q_i . q_(i-1) > 0); then r is C2 (C4) and passes through the q_i, and |r| stays far from zero, hence q
/// is C2 (C4) too, and w and a, exact by jets through r/|r|, are continuous. Full turns and half turns in the sum of
/// several pieces are nothing special, unlike for splines of rotation vectors or angles; turning all q_i by one
/// rotation, from the left or from the right, turns the motion by it; and the method is a linear system and a division,
/// unlike splines built on the group, whose C2 form is implicit (interpolating) or misses its points (B-splines). Its
/// price: between points far apart the speed is not even; keep neighbours within about 90 degrees. Neighbours half a
/// turn apart are refused, for the way round is not defined.
///
/// Ends: natural; clamped = at rest (quintic: without angular acceleration too); periodic: last orientation equal to
/// the first.
class LOCKSTEP_API SplineRotation final : public RotationLaw {
 public:
  using Points = std::vector<std::pair<double, Quat>>;
  /// Orientations of any length but zero. Throws ModelError: too few points, times that do not rise, zero or not finite
  /// quaternions, neighbours half a turn apart, periodic ends that do not meet, r too near to zero between points.
  explicit SplineRotation(const Points& points, const SplineSettings& = {});
  RotationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<RotationLaw> make(const Params&);

 private:
  SplineCurve curve_;
};

inline LawPtr<RotationLaw> spline_rotation(const SplineRotation::Points& points, const SplineSettings& k = {}) {
  return std::make_shared<const SplineRotation>(points, k);
}

}  // namespace lockstep
