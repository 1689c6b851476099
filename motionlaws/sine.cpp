// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <cmath>

#include <lockstep/math.h>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class Sine final : public MotionLaw {
 public:
  explicit Sine(const SineSettings& k) : k_(k) {
    require_finite("sine", {{"amplitude", k.amplitude}, {"omega", k.omega}, {"phase", k.phase}, {"offset", k.offset}});
  }
  LawValue at(double t) const override {
    const double a = k_.omega * t + k_.phase;
    const double s = k_.amplitude * std::sin(a), c = k_.amplitude * std::cos(a);
    return {k_.offset + s, k_.omega * c, -k_.omega * k_.omega * s};
  }

 private:
  SineSettings k_;
};

}  // namespace

LawPtr<MotionLaw> laws::sine(const SineSettings& k) { return std::make_shared<const Sine>(k); }

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
