// Laws 'sum', 'product', 'scale' and 'shift': laws made of laws. Breakpoints of the inner laws are passed on.
#pragma once

#include <utility>
#include <vector>

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// y = y_1 + y_2 + ...
class LOCKSTEP_API SumLaw final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a missing law.
  explicit SumLaw(std::vector<LawPtr<MotionLaw>> laws);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// y = y_1 y_2 ...
class LOCKSTEP_API ProductLaw final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a missing law.
  explicit ProductLaw(std::vector<LawPtr<MotionLaw>> laws);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// y = offset + factor law(t)
class LOCKSTEP_API ScaledLaw final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a number that is not finite.
  ScaledLaw(LawPtr<MotionLaw> law, double factor, double offset);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  LawPtr<MotionLaw> law_;
  double factor_, offset_;
};

/// y(t) = law(t - delay): the law, later by `delay` s (sooner when negative).
class LOCKSTEP_API ShiftedLaw final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a delay that is not finite.
  ShiftedLaw(LawPtr<MotionLaw> law, double delay);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  LawPtr<MotionLaw> law_;
  double delay_;
};

namespace laws {
inline LawPtr<MotionLaw> sum(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const SumLaw>(std::move(laws));
}
inline LawPtr<MotionLaw> product(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const ProductLaw>(std::move(laws));
}
inline LawPtr<MotionLaw> scale(LawPtr<MotionLaw> law, double factor, double offset = 0) {
  return std::make_shared<const ScaledLaw>(std::move(law), factor, offset);
}
inline LawPtr<MotionLaw> shift(LawPtr<MotionLaw> law, double delay) {
  return std::make_shared<const ShiftedLaw>(std::move(law), delay);
}
}  // namespace laws

}  // namespace lockstep
