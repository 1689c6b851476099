// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class Fourier final : public MotionLaw {
 public:
  explicit Fourier(FourierSettings k)
      : omega_(k.omega), offset_(k.offset), a_(std::move(k.cosines)), b_(std::move(k.sines)) {
    require_finite("fourier", {{"omega", omega_}, {"offset", offset_}});
    for (const double a : a_) require_finite("fourier", "cosines", a);
    for (const double b : b_) require_finite("fourier", "sines", b);
    const std::size_t n = std::max(a_.size(), b_.size());
    a_.resize(n, 0.0);
    b_.resize(n, 0.0);
  }
  LawValue at(double t) const override {
    LawValue r{offset_, 0.0, 0.0};
    for (std::size_t i = 0; i < a_.size(); ++i) {
      const double w = static_cast<double>(i + 1) * omega_, c = std::cos(w * t), s = std::sin(w * t);
      const double y = a_[i] * c + b_[i] * s;
      r.y += y;
      r.yd += w * (b_[i] * c - a_[i] * s);
      r.ydd -= w * w * y;
    }
    return r;
  }

 private:
  double omega_, offset_;
  std::vector<double> a_, b_;  // of equal length
};

}  // namespace

LawPtr<MotionLaw> laws::fourier(FourierSettings k) { return std::make_shared<const Fourier>(std::move(k)); }

void add_fourier(LawTypes& types) {
  types.laws.add(
      {"fourier",
       "y = offset + sum a_k cos(k omega t) + b_k sin(k omega t), k = 1, 2, ...",
       {{"omega", Form::number, Unit::angular_speed, kOptional, "base circular frequency; this or frequency"},
        {"frequency", Form::number, Unit::frequency, kOptional, "base cycles per second; this or omega"},
        value_key("offset", Form::number, 0, "mean value"),
        value_key("cosines", Form::numbers, Value::List{}, "a_1, a_2, ..."),
        value_key("sines", Form::numbers, Value::List{}, "b_1, b_2, ...")}},
      [](const Params& p) {
        return laws::fourier({omega_of(p), p.number("offset"), p.numbers("cosines"), p.numbers("sines")});
      });
}

}  // namespace lockstep
