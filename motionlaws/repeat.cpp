// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "motionlaws/law_types.h"
#include "motionlaws/side.h"

namespace lockstep {
namespace {

class Repeat final : public MotionLaw {
 public:
  Repeat(LawPtr<MotionLaw> law, double period, const RepeatSettings& k)
      : law_(std::move(law)), period_(period), t0_(k.t0) {
    require_law("repeat", "law", law_);
    require_positive("repeat", "period", period);
    require_finite("repeat", "t0", k.t0);
    const LawValue start = law_->at(0), end = left_limit(*law_, period, period);
    if (k.drift) gain_ = law_->at(period).y - start.y;
    jump_ = differs(end, raised(start, gain_), size_of(*law_, 0, period));
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
      const double from = std::max(t0 - start, 0.0), to = std::min(t1 - start, period_);
      if (from < to) append_breakpoints(*law_, from, to, start, out);
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
