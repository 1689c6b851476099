// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <cmath>

#include <lockstep/math.h>

#include "motionlaws/law_types.h"
#include "motionlaws/side.h"

namespace lockstep {
namespace {

TypeInfo rise_info(const char* name, const char* help) {
  return {name,
          help,
          {value_key("rise", Form::number, kRequired, "h, change of y; may be negative"),
           {"duration", Form::number, Unit::time, kRequired, "T, duration of the rise"},
           {"t0", Form::number, Unit::time, 0, "start of the rise"},
           value_key("y0", Form::number, 0, "value before the rise")}};
}

RiseSettings rise_settings(const Params& p) {
  return {p.number("rise"), p.number("duration"), p.number("t0"), p.number("y0")};
}

// s, s', s'' of a shape for u in [0, 1].
using RiseShape = LawValue (*)(double u);

class Rise final : public MotionLaw {
 public:
  Rise(const char* law, const RiseSettings& k, RiseShape shape) : k_(k), shape_(shape) {
    require_finite(law, "rise", k.rise);
    require_positive(law, "duration", k.duration);
    require_finite(law, {{"t0", k.t0}, {"y0", k.y0}});
  }
  LawValue at(double t) const override {
    const double u = (t - k_.t0) / k_.duration;
    if (u < -kEarly) return held(k_.y0);
    if (u >= 1.0 - kEarly) return held(k_.y0 + k_.rise);
    const LawValue s = shape_(u);
    const double v = k_.rise / k_.duration;
    return {k_.y0 + k_.rise * s.y, v * s.yd, v / k_.duration * s.ydd};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const double t : {k_.t0, k_.t0 + k_.duration})
      if (k_.rise != 0.0 && t0 < t && t < t1) out.push_back(t);
  }

 private:
  RiseSettings k_;
  RiseShape shape_;
};

LawValue poly345_shape(double u) {
  const double w = 1.0 - u;
  return {u * u * u * (10.0 - u * (15.0 - 6.0 * u)), 30.0 * u * u * w * w, 60.0 * u * w * (1.0 - 2.0 * u)};
}

LawValue cycloid_shape(double u) {
  const double s = std::sin(kTwoPi * u), c = std::cos(kTwoPi * u);
  return {u - s / kTwoPi, 1.0 - c, kTwoPi * s};
}

LawValue harmonic_shape(double u) {
  const double s = std::sin(kPi * u), c = std::cos(kPi * u);
  return {0.5 * (1.0 - c), 0.5 * kPi * s, 0.5 * kPi * kPi * c};
}

}  // namespace

LawPtr<MotionLaw> laws::poly345(const RiseSettings& k) {
  return std::make_shared<const Rise>("poly345", k, poly345_shape);
}
LawPtr<MotionLaw> laws::cycloid(const RiseSettings& k) {
  return std::make_shared<const Rise>("cycloid", k, cycloid_shape);
}
LawPtr<MotionLaw> laws::harmonic_rise(const RiseSettings& k) {
  return std::make_shared<const Rise>("harmonic_rise", k, harmonic_shape);
}

void add_rise(LawTypes& types) {
  types.laws.add(rise_info("poly345", "rise h (10 u^3 - 15 u^4 + 6 u^5), u = (t - t0)/T, constant outside"),
                 [](const Params& p) { return laws::poly345(rise_settings(p)); });
  types.laws.add(rise_info("cycloid", "rise h (u - sin(2 pi u)/(2 pi)), u = (t - t0)/T, constant outside"),
                 [](const Params& p) { return laws::cycloid(rise_settings(p)); });
  types.laws.add(rise_info("harmonic_rise", "rise h (1 - cos(pi u))/2, u = (t - t0)/T, constant outside"),
                 [](const Params& p) { return laws::harmonic_rise(rise_settings(p)); });
}

}  // namespace lockstep
