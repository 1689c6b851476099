// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <lockstep/math.h>

#include "motionlaws/law_types.h"

namespace lockstep {

LawPtr<MotionLaw> laws::sine(const SineSettings& k) {
  require_finite("sine", {{"amplitude", k.amplitude}, {"omega", k.omega}, {"phase", k.phase}, {"offset", k.offset}});
  return law([k](Time t) { return k.offset + k.amplitude * sin(k.omega * t + k.phase); });
}

double omega_of(const Params& p) {
  if (p.has("omega") && p.has("frequency")) p.refuse("frequency", "is given as well as omega; give one of the two");
  if (!p.has("omega") && !p.has("frequency")) p.refuse("omega", "is missing; give omega or frequency");
  return p.has("omega") ? p.number("omega") : kTwoPi * p.number("frequency");
}

void add_sine(LawTypes& types) {
  types.laws.add({"sine",
                  "y = offset + amplitude sin(omega t + phase)",
                  {value_key("amplitude", Form::number, 1, "half the range, in the unit of the driven quantity"),
                   {"omega", Form::number, Unit::angular_speed, kOptional, "circular frequency; this or frequency"},
                   {"frequency", Form::number, Unit::frequency, kOptional, "cycles per second; this or omega"},
                   {"phase", Form::number, Unit::angle, 0, "angle at t = 0"},
                   value_key("offset", Form::number, 0, "mean value")}},
                 [](const Params& p) {
                   return laws::sine({p.number("amplitude"), omega_of(p), p.number("phase"), p.number("offset")});
                 });
}

}  // namespace lockstep
