// Law 'repeat'.
#pragma once

#include "framework/mechanism/params/params.h"

namespace lockstep {

struct RepeatSettings {
  double t0 = 0;       ///< a start of the period, s
  bool drift = false;  ///< each period adds what the law gained over one: y(period) - y(0)
};

/// y = law(s) + n d for all t, s = t - t0 - n period in [0, period), n whole, d = law(period) - law(0) with drift, else
/// 0. Breakpoints: those of the law in (0, period), and the start of each period when y, yd or ydd jumps there.
class LOCKSTEP_API Repeat final : public MotionLaw {
 public:
  /// Throws ModelError for no law or a period not above 0.
  Repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings&);
  LawValue at(double t) const override;
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  LawPtr<MotionLaw> law_;
  double period_, t0_, gain_ = 0;
  bool jump_ = false;
};

namespace laws {
inline LawPtr<MotionLaw> repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k = {}) {
  return std::make_shared<const Repeat>(std::move(law), period, k);
}
}  // namespace laws

}  // namespace lockstep
