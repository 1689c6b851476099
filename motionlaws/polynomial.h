// Law 'polynomial'.
#pragma once

#include <vector>

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// y = c0 + c1 (t - t0) + c2 (t - t0)^2 + ..., for all t. c_k in the unit of the coordinate per s^k, t0 in s.
class LOCKSTEP_API Polynomial final : public MotionLaw {
 public:
  /// Throws ModelError for an empty list or a number that is not finite.
  Polynomial(std::vector<double> coefficients, double t0);
  LawValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  std::vector<double> c_;
  double t0_;
};

namespace laws {
inline LawPtr<MotionLaw> polynomial(std::vector<double> coefficients, double t0 = 0) {
  return std::make_shared<const Polynomial>(std::move(coefficients), t0);
}
}  // namespace laws

}  // namespace lockstep
