// Law 'ramp'.
#pragma once

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// y = y0 + slope (t - t0), for all t. t0 in s, y0 in the unit of the coordinate, slope in that unit per s.
class LOCKSTEP_API Ramp final : public MotionLaw {
 public:
  /// Throws ModelError unless all are finite.
  Ramp(double slope, double t0, double y0);
  LawValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  double slope_, t0_, y0_;
};

namespace laws {
inline LawPtr<MotionLaw> ramp(double slope, double t0 = 0, double y0 = 0) {
  return std::make_shared<const Ramp>(slope, t0, y0);
}
}  // namespace laws

}  // namespace lockstep
