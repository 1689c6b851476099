// SPDX-License-Identifier: BSD-3-Clause
// Laws of translations and rotations.
#pragma once

#include <array>
#include <vector>

#include <lockstep/author/params.h>

namespace lockstep {

// Rotation laws 'constant', 'axis_rotation' and 'product'. Angular velocity w and acceleration a are in the axes of the
// moved frame.

/// A fixed orientation, q = orientation.
class LOCKSTEP_API ConstantRotation final : public RotationLaw {
 public:
  /// `orientation` of any length but zero. Throws ModelError when it is zero or not finite.
  explicit ConstantRotation(const Quat& orientation);
  RotationValue at(double t) const override;
  bool turns_about(const Vec3& axis) const override;
  static const TypeInfo& info();                   ///< name and keys of its type
  static LawPtr<RotationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  Quat q_;
};

/// A turn about a fixed axis: q = (cos(y/2), n sin(y/2)), w = n yd, a = n ydd, with the scalar law y, rad, and the axis
/// n of length 1, which has the same components in the frame and in the moved frame.
class LOCKSTEP_API AxisRotation final : public RotationLaw {
 public:
  /// `axis` of any length but zero. Throws ModelError for a zero axis, numbers that are not finite, no law.
  AxisRotation(const Vec3& axis, LawPtr<MotionLaw> law);
  RotationValue at(double t) const override;
  bool turns_about(const Vec3& axis) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                   ///< name and keys of its type
  static LawPtr<RotationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  Vec3 axis_;
  LawPtr<MotionLaw> law_;
};

/// Two rotations one after the other: q = q1 q2, q2 about the axes turned by q1. As (4.10), with A2 = A(q2):
/// w = A2^T w1 + w2, a = A2^T a1 + a2 + (A2^T w1) x w2.
class LOCKSTEP_API RotationProduct final : public RotationLaw {
 public:
  /// Throws ModelError for a missing law.
  RotationProduct(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second);
  RotationValue at(double t) const override;
  bool turns_about(const Vec3& axis) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                   ///< name and keys of its type
  static LawPtr<RotationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  LawPtr<RotationLaw> first_, second_;
};

namespace laws {
/// A ConstantRotation.
LOCKSTEP_API LawPtr<RotationLaw> constant_rotation(const Quat& orientation);
/// An AxisRotation.
LOCKSTEP_API LawPtr<RotationLaw> axis_rotation(const Vec3& axis, LawPtr<MotionLaw> law);
/// A RotationProduct q1 q2.
LOCKSTEP_API LawPtr<RotationLaw> rotation_product(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second);
}  // namespace laws

// Translation laws 'constant', 'components' and 'along'. Axes are those of the frame in which the law is imposed.

/// A fixed translation, x = value, m.
class LOCKSTEP_API ConstantTranslation final : public TranslationLaw {
 public:
  /// Throws ModelError unless finite.
  explicit ConstantTranslation(const Vec3& value);
  TranslationValue at(double t) const override;
  bool stays_in_plane(const Vec3& normal) const override;
  static const TypeInfo& info();                      ///< name and keys of its type
  static LawPtr<TranslationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  Vec3 value_;
};

/// A scalar law, m, for each component: x = (x(t), y(t), z(t)).
class LOCKSTEP_API ComponentsLaw final : public TranslationLaw {
 public:
  /// Throws ModelError for a missing law.
  ComponentsLaw(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z);
  TranslationValue at(double t) const override;
  bool stays_in_plane(const Vec3& normal) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                      ///< name and keys of its type
  static LawPtr<TranslationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  std::array<LawPtr<MotionLaw>, 3> laws_;
};

/// A translation along a line: x = origin + n s(t), m, with the scalar law s, m, and the direction n of length 1.
class LOCKSTEP_API AlongLaw final : public TranslationLaw {
 public:
  /// `axis` of any length but zero. Throws ModelError for a zero axis, numbers that are not finite, no law.
  AlongLaw(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin);
  TranslationValue at(double t) const override;
  bool stays_in_plane(const Vec3& normal) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();                      ///< name and keys of its type
  static LawPtr<TranslationLaw> make(const Params&);  ///< the law from parameters checked against info()

 private:
  Vec3 axis_, origin_;
  LawPtr<MotionLaw> law_;
};

namespace laws {
/// A ConstantTranslation, m.
LOCKSTEP_API LawPtr<TranslationLaw> constant_translation(const Vec3& value);
/// A ComponentsLaw.
LOCKSTEP_API LawPtr<TranslationLaw> components(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z);
/// An AlongLaw: x = origin + n law(t), n along `axis`.
LOCKSTEP_API LawPtr<TranslationLaw> along(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin = Vec3::Zero());
}  // namespace laws

}  // namespace lockstep
