// Law 'constant'.
#pragma once

#include "framework/mechanism/params/params.h"

namespace lockstep {

/// y = value, for all t. Unit: that of the coordinate it drives.
class LOCKSTEP_API Constant final : public MotionLaw {
 public:
  /// Throws ModelError unless finite.
  explicit Constant(double value);
  LawValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  double value_;
};

namespace laws {
inline LawPtr<MotionLaw> constant(double value) { return std::make_shared<const Constant>(value); }
}  // namespace laws

}  // namespace lockstep
