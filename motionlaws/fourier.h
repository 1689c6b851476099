// Law 'fourier'.
#pragma once

#include <vector>

#include "framework/mechanism/params/params.h"

namespace lockstep {

struct FourierSettings {
  double omega = 1;               ///< base circular frequency, rad/s
  double offset = 0;              ///< unit of the coordinate
  std::vector<double> cosines{};  ///< a_1, a_2, ...
  std::vector<double> sines{};    ///< b_1, b_2, ...; the lists may differ in length
};

/// y = offset + sum over k = 1, 2, ... of a_k cos(k omega t) + b_k sin(k omega t), for all t.
class LOCKSTEP_API Fourier final : public MotionLaw {
 public:
  /// Throws ModelError unless all are finite.
  explicit Fourier(FourierSettings);
  LawValue at(double t) const override;
  static const TypeInfo& info();
  static LawPtr<MotionLaw> make(const Params&);

 private:
  double omega_, offset_;
  std::vector<double> a_, b_;  // of equal length
};

namespace laws {
inline LawPtr<MotionLaw> fourier(FourierSettings k) { return std::make_shared<const Fourier>(std::move(k)); }
}  // namespace laws

}  // namespace lockstep
