// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <cassert>
#include <cmath>
#include <utility>

#include "motionlaws/law_types.h"
#include "motionlaws/side.h"

namespace lockstep {
namespace {

// Whether y, yd or ydd jumps by more than 1e-10 of its size from the end of a period, extrapolated from below, to the
// start of the next one, which is higher by `gain`.
bool jumps_at_seam(const MotionLaw& law, double period, double gain) {
  constexpr double kNoise = 1e-10;
  const double d = 1e-9 * period;
  const LawValue start = raised(law.at(0), gain), near = law.at(period - d), far = law.at(period - 2 * d);
  const Vec3 jump(near.y + d * near.yd - start.y, near.yd + d * near.ydd - start.yd,
                  2 * near.ydd - far.ydd - start.ydd);
  Vec3 size = Vec3::Zero();
  for (const double u : {0.0, 0.13, 0.29, 0.5, 0.71, 0.87, 0.999}) {
    const LawValue v = law.at(u * period);
    size = size.cwiseMax(Vec3(v.y, v.yd, v.ydd).cwiseAbs());
  }
  return (jump.array().abs() > kNoise * size.array()).any();
}

class Repeat final : public MotionLaw {
 public:
  Repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k)
      : law_(std::move(law)), period_(period), t0_(k.t0) {
    require_law("repeat", "law", law_);
    require_positive("repeat", "period", period);
    require_finite("repeat", "t0", k.t0);
    if (k.drift) gain_ = law_->at(period).y - law_->at(0).y;
    jump_ = jumps_at_seam(*law_, period, gain_);
  }
  LawValue at(double t) const override {
    double s = std::fmod(t - t0_, period_);
    if (s < 0) s += period_;
    double n = std::round((t - t0_ - s) / period_);
    if (s >= period_ * (1.0 - kEarly)) s = 0, n += 1;  // counts as the start of the next one
    return raised(law_->at(s), n * gain_);
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    assert(std::isfinite(t0) && std::isfinite(t1));
    for (double n = std::floor((t0 - t0_) / period_); t0_ + n * period_ < t1; ++n) {
      const double start = t0_ + n * period_;
      if (jump_ && t0 < start) out.push_back(start);
      append_breakpoints({*law_, start, 0.0, period_}, t0, t1, out);
    }
  }

 private:
  LawPtr<MotionLaw> law_;
  double period_, t0_, gain_ = 0;
  bool jump_ = false;
};

}  // namespace

LawPtr<MotionLaw> laws::repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k) {
  return std::make_shared<const Repeat>(std::move(law), period, k);
}

void add_repeat(LawTypes& types) {
  types.laws.add({"repeat",
                  "one period of a law, repeated",
                  {value_key("law", Form::law, kRequired, "the law, used from its time 0 to period"),
                   {"period", Form::number, Unit::time, kRequired, "length of the period"},
                   {"drift", Form::boolean, Unit::none, false,
                    "each period continues from the value at which the one before ended"},
                   {"t0", Form::number, Unit::time, 0, "start of a period"}}},
                 [](const Params& p) {
                   return laws::repeat(p.law("law"), p.number("period"), {p.number("t0"), p.boolean("drift")});
                 });
}

}  // namespace lockstep
