// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/function_laws.h>
#include <lockstep/laws.h>

#include <utility>

#include "motionlaws/law_types.h"

namespace lockstep {

LawPtr<MotionLaw> laws::polynomial(std::vector<double> coefficients, double t0) {
  require(!coefficients.empty(), "polynomial", "coefficients", "is empty; give at least c0");
  for (const double c : coefficients) require_finite("polynomial", "coefficients", c);
  require_finite("polynomial", "t0", t0);
  return law([c = std::move(coefficients), t0](Time t) {  // Horner's rule
    Time y(0.0);
    for (std::size_t k = c.size(); k-- > 0;) y = y * (t - t0) + c[k];
    return y;
  });
}

void add_polynomial(LawTypes& types) {
  types.laws.add({"polynomial",
                  "y = c0 + c1 (t - t0) + c2 (t - t0)^2 + ...",
                  {value_key("coefficients", Form::numbers, kRequired, "c0, c1, c2, ...", LawQuantity::coefficients),
                   {"t0", Form::number, Unit::time, 0, "origin of time"}}},
                 [](const Params& p) { return laws::polynomial(p.numbers("coefficients"), p.number("t0")); });
}

}  // namespace lockstep
