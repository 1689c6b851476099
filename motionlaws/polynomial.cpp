// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <utility>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class Polynomial final : public MotionLaw {
 public:
  Polynomial(std::vector<double> coefficients, double t0) : c_(std::move(coefficients)), t0_(t0) {
    require(!c_.empty(), "polynomial", "coefficients", "is empty; give at least c0");
    for (const double c : c_) require_finite("polynomial", "coefficients", c);
    require_finite("polynomial", "t0", t0);
  }
  // Horner's rule for the value and both derivatives.
  LawValue at(double t) const override {
    const double u = t - t0_;
    LawValue r;
    for (std::size_t k = c_.size(); k-- > 0;) {
      r.ydd = r.ydd * u + 2.0 * r.yd;
      r.yd = r.yd * u + r.y;
      r.y = r.y * u + c_[k];
    }
    return r;
  }

 private:
  std::vector<double> c_;
  double t0_;
};

}  // namespace

LawPtr<MotionLaw> laws::polynomial(std::vector<double> coefficients, double t0) {
  return std::make_shared<const Polynomial>(std::move(coefficients), t0);
}

void add_polynomial(LawTypes& types) {
  types.laws.add({"polynomial",
                  "y = c0 + c1 (t - t0) + c2 (t - t0)^2 + ...",
                  {value_key("coefficients", Form::numbers, kRequired, "c0, c1, c2, ...", LawQuantity::coefficients),
                   {"t0", Form::number, Unit::time, 0, "origin of time"}}},
                 [](const Params& p) { return laws::polynomial(p.numbers("coefficients"), p.number("t0")); });
}

}  // namespace lockstep
