// SPDX-License-Identifier: BSD-3-Clause
// A law as a plugin: one smooth bump, y = height (1 - u^2)^3 with u = (t - at)/width, zero outside |u| < 1.
#include <lockstep/author/plugin.h>

namespace {

using namespace lockstep;

class Bump final : public MotionLaw {
 public:
  Bump(double height, double at, double width) : height_(height), at_(at), width_(width) {}

  LawValue at(double t) const override {
    const double u = (t - at_) / width_;
    if (u <= -1 || u >= 1) return {};
    const double r = 1 - u * u;
    return {height_ * r * r * r, height_ * -6 * u * r * r / width_,
            height_ * 6 * r * (5 * u * u - 1) / (width_ * width_)};
  }

  /// Its ends: without them an adaptive method may step over the whole bump, although y, yd and ydd are continuous.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const double end : {at_ - width_, at_ + width_})
      if (t0 < end && end < t1) out.push_back(end);
  }

  static TypeInfo info() {
    return {"bump",
            "one smooth bump: height (1 - u^2)^3, u = (t - at)/width, zero outside",
            {{"height", Form::number, Unit::any, kRequired, "value at the top", {}, LawQuantity::value},
             {"at", Form::number, Unit::time, kRequired, "time of the top"},
             {"width", Form::number, Unit::time, kRequired, "half of its duration, above zero"}}};
  }

  static LawPtr<MotionLaw> make(const Params& p) {
    if (!(p.number("width") > 0))
      p.refuse("width", "is " + text::brief(p.number("width")) + " s; it must be above zero");
    return std::make_shared<Bump>(p.number("height"), p.number("at"), p.number("width"));
  }

 private:
  double height_, at_, width_;
};

}  // namespace

LOCKSTEP_PLUGIN(registry) { registry.laws.add<Bump>(); }
