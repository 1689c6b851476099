// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/function_laws.h>
#include <lockstep/laws.h>

#include "motionlaws/law_types.h"

namespace lockstep {

LawPtr<MotionLaw> laws::ramp(double slope, double t0, double y0) {
  require_finite("ramp", {{"slope", slope}, {"t0", t0}, {"y0", y0}});
  return law([=](Time t) { return y0 + slope * (t - t0); });
}

void add_ramp(LawTypes& types) {
  types.laws.add({"ramp",
                  "y = y0 + slope (t - t0)",
                  {value_key("slope", Form::number, kRequired, "rate of y, its unit per second", LawQuantity::rate),
                   {"t0", Form::number, Unit::time, 0, "time at which y = y0"},
                   value_key("y0", Form::number, 0, "value at t0")}},
                 [](const Params& p) { return laws::ramp(p.number("slope"), p.number("t0"), p.number("y0")); });
}

}  // namespace lockstep
