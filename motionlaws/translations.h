// Translation laws 'constant', 'components' and 'along'. The axes are those of the frame in which the law is imposed.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// x = value, m.
class LOCKSTEP_API ConstantTranslation final : public TranslationLaw {
 public:
  /// Throws ModelError unless finite.
  explicit ConstantTranslation(const Vec3& value);
  TranslationValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<TranslationLaw> make(const Params&);

 private:
  Vec3 value_;
};

/// x = (x(t), y(t), z(t)), m: a scalar law for each component.
class LOCKSTEP_API ComponentsLaw final : public TranslationLaw {
 public:
  /// Throws ModelError for a missing law.
  ComponentsLaw(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z);
  TranslationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<TranslationLaw> make(const Params&);

 private:
  std::array<LawPtr<MotionLaw>, 3> laws_;
};

/// x = origin + n s(t), m: the scalar law s, m, along the direction n of length 1.
class LOCKSTEP_API AlongLaw final : public TranslationLaw {
 public:
  /// `axis` of any length but zero. Throws ModelError for a zero axis, numbers that are not finite, no law.
  AlongLaw(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin);
  TranslationValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<TranslationLaw> make(const Params&);

 private:
  Vec3 axis_, origin_;
  LawPtr<MotionLaw> law_;
};

inline LawPtr<TranslationLaw> constant_translation(const Vec3& value) {
  return std::make_shared<const ConstantTranslation>(value);
}
namespace laws {
inline LawPtr<TranslationLaw> components(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z) {
  return std::make_shared<const ComponentsLaw>(std::move(x), std::move(y), std::move(z));
}
inline LawPtr<TranslationLaw> along(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin = Vec3::Zero()) {
  return std::make_shared<const AlongLaw>(axis, std::move(law), origin);
}
}  // namespace laws

}  // namespace lockstep
