// Rotation laws 'constant', 'axis_rotation' and 'product'. Angular velocity w and acceleration a are in the moved
// frame's axes.
#pragma once

#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// q = orientation.
class LOCKSTEP_API ConstantRotation final : public RotationLaw {
 public:
  /// `orientation` of any length but zero. Throws ModelError when it is zero or not finite.
  explicit ConstantRotation(const Quat& orientation);
  RotationValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<RotationLaw> make(const Params&);

 private:
  Quat q_;
};

/// q = (cos(y/2), n sin(y/2)), w = n yd, a = n ydd: turn by the scalar law y, rad, about the axis n of length 1, which
/// has the same components in the frame and in the moved frame.
class LOCKSTEP_API AxisRotation final : public RotationLaw {
 public:
  /// `axis` of any length but zero. Throws ModelError for a zero axis, numbers that are not finite, no law.
  AxisRotation(const Vec3& axis, LawPtr<MotionLaw> law);
  RotationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<RotationLaw> make(const Params&);

 private:
  Vec3 axis_;
  LawPtr<MotionLaw> law_;
};

/// q = q1 q2: first the turn q1, then q2 about the axes turned by q1. As (4.10), with A2 = A(q2):
/// w = A2^T w1 + w2, a = A2^T a1 + a2 + (A2^T w1) x w2.
class LOCKSTEP_API RotationProduct final : public RotationLaw {
 public:
  /// Throws ModelError for a missing law.
  RotationProduct(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second);
  RotationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<RotationLaw> make(const Params&);

 private:
  LawPtr<RotationLaw> first_, second_;
};

inline LawPtr<RotationLaw> constant_rotation(const Quat& orientation) {
  return std::make_shared<const ConstantRotation>(orientation);
}
inline LawPtr<RotationLaw> axis_rotation(const Vec3& axis, LawPtr<MotionLaw> law) {
  return std::make_shared<const AxisRotation>(axis, std::move(law));
}
inline LawPtr<RotationLaw> rotation_product(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second) {
  return std::make_shared<const RotationProduct>(std::move(first), std::move(second));
}

}  // namespace lockstep
