// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <algorithm>
#include <cmath>

#include "motionlaws/law_types.h"
#include "motionlaws/side.h"

namespace lockstep {
namespace {

class Trapezoid final : public MotionLaw {
 public:
  explicit Trapezoid(const TrapezoidSettings& k) : t0_(k.t0), y0_(k.y0) {
    const char* law = "trapezoid";
    require_finite(law, {{"distance", k.distance}, {"t0", k.t0}, {"y0", k.y0}});
    for (const auto& [key, value] :
         {std::pair{"speed", k.speed}, std::pair{"acceleration", k.acceleration}, std::pair{"duration", k.duration}})
      require(std::isfinite(value) && value >= 0, law, key, "is " + text::number(value) + "; must be above 0");
    const int n_given = (k.speed > 0) + (k.acceleration > 0) + (k.duration > 0);
    require(n_given == 2, law, "speed",
            "is one of three, speed, acceleration and duration, of which " + text::number(n_given) +
                " are given; give two");
    if (k.distance != 0) solve(k);
  }
  LawValue at(double t) const override {
    const double s = t - t0_ + kEarly * T_;  // chooses the piece; the value itself is taken at t
    const double u = t - t0_, r = T_ - u;    // time since the start, time to go
    if (s < 0) return held(y0_);
    if (s >= T_) return held(y0_ + d_);
    if (s >= T_ - ta_) return {y0_ + d_ - 0.5 * a_ * r * r, a_ * r, -a_};
    if (s >= ta_) return {y0_ + v_ * (u - 0.5 * ta_), v_, 0.0};
    return {y0_ + 0.5 * a_ * u * u, a_ * u, a_};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (d_ == 0) return;
    const bool plateau = T_ - 2.0 * ta_ > kEarly * T_;
    const double instants[] = {t0_, t0_ + ta_, t0_ + (T_ - ta_), t0_ + T_};
    for (int i = 0; i < 4; ++i)
      if ((plateau || i != 2) && t0 < instants[i] && instants[i] < t1) out.push_back(instants[i]);
  }

 private:
  // d = v (T - v/a) with d, v, a > 0.
  void solve(TrapezoidSettings k) {
    const double d = std::abs(k.distance), sign = k.distance < 0 ? -1.0 : 1.0;
    double v = k.speed, a = k.acceleration, T = k.duration;
    if (T == 0) {
      v = std::min(v, std::sqrt(d * a));  // a short distance makes a triangle
      T = d / v + v / a;
    } else if (v == 0) {
      const double least = 2.0 * std::sqrt(d / a), root = T * T - least * least;
      require(T >= least * (1.0 - kEarly), "trapezoid", "duration",
              "is " + text::number(T) + " s; at this acceleration the distance takes at least " + text::number(least) +
                  " s");
      v = 2.0 * d / (T + std::sqrt(std::max(root, 0.0)));
    } else {
      require(v * T > d && v * T <= 2.0 * d * (1.0 + kEarly), "trapezoid", "speed",
              "is " + text::number(v) + "; for this distance and duration it must be above " + text::number(d / T) +
                  " and at most " + text::number(2.0 * d / T));
      a = v * v / (v * T - d);
    }
    d_ = sign * d, v_ = sign * v, a_ = sign * a, T_ = T;
    ta_ = std::min(v / a, 0.5 * T);
  }
  double d_ = 0, v_ = 0, a_ = 0, ta_ = 0,
         T_ = 0;  // signed distance, speed and acceleration; times of speeding up and of all
  double t0_, y0_;
};

}  // namespace

LawPtr<MotionLaw> laws::trapezoid(const TrapezoidSettings& k) { return std::make_shared<const Trapezoid>(k); }

void add_trapezoid(LawTypes& types) {
  types.laws.add(
      {"trapezoid",
       "a distance at trapezoidal speed: linear rise, constant, linear fall; y constant outside",
       {value_key("distance", Form::number, kRequired, "change of y; may be negative"),
        value_key("speed", Form::number, kOptional, "largest speed; two of speed, acceleration, duration",
                  LawQuantity::rate),
        value_key("acceleration", Form::number, kOptional, "magnitude of the acceleration while it is not zero",
                  LawQuantity::acceleration),
        {"duration", Form::number, Unit::time, kOptional, "total duration"},
        {"t0", Form::number, Unit::time, 0, "start"},
        value_key("y0", Form::number, 0, "value before the start")}},
      [](const Params& p) {
        const auto given = [&](const char* key) {
          if (!p.has(key)) return 0.0;
          const double value = p.number(key);
          if (!(value > 0)) p.refuse(key, "is " + text::number(value) + "; must be above 0");
          return value;
        };
        return laws::trapezoid({p.number("distance"), given("speed"), given("acceleration"), given("duration"),
                                p.number("t0"), p.number("y0")});
      });
}

}  // namespace lockstep
