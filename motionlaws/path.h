// Translation law 'path'.
#pragma once

#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"
#include "motionlaws/spline_curve.h"

namespace lockstep {

/// Rates at clamped ends, m/s and m/s^2 (the latter for the quintic only).
struct PathEndValues {
  Vec3 start_velocity = Vec3::Zero(), end_velocity = Vec3::Zero();
  Vec3 start_acceleration = Vec3::Zero(), end_acceleration = Vec3::Zero();
};

/// x(t), m: a cubic or quintic spline for each component through the points (t_i, x_i), times in s. See Spline.
class LOCKSTEP_API PathLaw final : public TranslationLaw {
 public:
  using Points = std::vector<std::pair<double, Vec3>>;
  /// Throws ModelError: too few points, times that do not rise, numbers not finite, periodic ends that do not meet.
  explicit PathLaw(const Points& points, const SplineSettings& = {}, const PathEndValues& = {});
  explicit PathLaw(SplineCurve curve) : curve_(std::move(curve)) {}
  TranslationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<TranslationLaw> make(const Params&);

 private:
  SplineCurve curve_;
};

namespace laws {
inline LawPtr<TranslationLaw> path(const PathLaw::Points& points, const SplineSettings& k = {},
                                   const PathEndValues& ends = {}) {
  return std::make_shared<const PathLaw>(points, k, ends);
}
}  // namespace laws

}  // namespace lockstep
