// Law 'sine'.
#pragma once

#include "framework/mechanism/params/params.h"

namespace lockstep {

struct SineSettings {
  double amplitude = 1;  ///< unit of the coordinate
  double omega = 1;      ///< rad/s
  double phase = 0;      ///< rad
  double offset = 0;     ///< unit of the coordinate
};

/// y = offset + amplitude sin(omega t + phase), for all t.
class LOCKSTEP_API Sine final : public MotionLaw {
 public:
  /// Throws ModelError unless all are finite.
  explicit Sine(const SineSettings&);
  LawValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  SineSettings k_;
};

namespace laws {
inline LawPtr<MotionLaw> sine(const SineSettings& k) { return std::make_shared<const Sine>(k); }
}  // namespace laws

}  // namespace lockstep
