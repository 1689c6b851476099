// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <utility>

#include "motionlaws/law_types.h"
#include "motionlaws/side.h"

namespace lockstep {
namespace {

// The value of two of the laws.
using Combine = LawValue (*)(const LawValue& a, const LawValue& b);

class CombinedLaws final : public MotionLaw {
 public:
  // `neutral`: a value that leaves those it is combined with.
  CombinedLaws(const char* type, std::vector<LawPtr<MotionLaw>> laws, double neutral, Combine combine)
      : laws_(std::move(laws)), neutral_(neutral), combine_(combine) {
    require(!laws_.empty(), type, "laws", "are missing; give at least one");
    for (const auto& law : laws_) require_law(type, "laws", law);
  }
  LawValue at(double t) const override {
    LawValue r = held(neutral_);
    for (const auto& law : laws_) r = combine_(r, law->at(t));
    return r;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const auto& law : laws_) law->breakpoints(t0, t1, out);
  }

 private:
  std::vector<LawPtr<MotionLaw>> laws_;
  double neutral_;
  Combine combine_;
};

LawValue sum_of(const LawValue& a, const LawValue& b) { return {a.y + b.y, a.yd + b.yd, a.ydd + b.ydd}; }
LawValue product_of(const LawValue& a, const LawValue& b) {
  return {a.y * b.y, a.yd * b.y + a.y * b.yd, a.ydd * b.y + 2.0 * a.yd * b.yd + a.y * b.ydd};
}

// y = offset + factor law(t - delay): what scale and shift have in common.
class MappedLaw final : public MotionLaw {
 public:
  MappedLaw(LawPtr<MotionLaw> law, double factor, double offset, double delay)
      : law_(std::move(law)), factor_(factor), offset_(offset), delay_(delay) {}
  LawValue at(double t) const override {
    const LawValue v = law_->at(t - delay_);
    return {offset_ + factor_ * v.y, factor_ * v.yd, factor_ * v.ydd};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (factor_ != 0.0) append_breakpoints({*law_, delay_}, t0, t1, out);
  }

 private:
  LawPtr<MotionLaw> law_;
  double factor_, offset_, delay_;
};

}  // namespace

LawPtr<MotionLaw> laws::sum(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const CombinedLaws>("sum", std::move(laws), 0, sum_of);
}
LawPtr<MotionLaw> laws::product(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const CombinedLaws>("product", std::move(laws), 1, product_of);
}
LawPtr<MotionLaw> laws::scale(LawPtr<MotionLaw> law, double factor, double offset) {
  require_law("scale", "law", law);
  require_finite("scale", {{"factor", factor}, {"offset", offset}});
  return std::make_shared<const MappedLaw>(std::move(law), factor, offset, 0);
}
LawPtr<MotionLaw> laws::shift(LawPtr<MotionLaw> law, double delay) {
  require_law("shift", "law", law);
  require_finite("shift", "delay", delay);
  return std::make_shared<const MappedLaw>(std::move(law), 1, 0, delay);
}

void add_combine(LawTypes& types) {
  types.laws.add({"sum", "y = y_1 + y_2 + ...", {value_key("laws", Form::laws, kRequired, "the addends")}},
                 [](const Params& p) { return laws::sum(p.laws("laws")); });
  types.laws.add({"product", "y = y_1 y_2 ...", {{"laws", Form::laws, Unit::none, kRequired, "the factors"}}},
                 [](const Params& p) { return laws::product(p.laws("laws")); });
  types.laws.add({"scale",
                  "y = offset + factor law(t)",
                  {{"law", Form::law, Unit::none, kRequired, "the law that is scaled"},
                   {"factor", Form::number, Unit::any, 1, "factor of its value"},
                   value_key("offset", Form::number, 0, "added to the product")}},
                 [](const Params& p) { return laws::scale(p.law("law"), p.number("factor"), p.number("offset")); });
  types.laws.add({"shift",
                  "y(t) = law(t - delay)",
                  {value_key("law", Form::law, kRequired, "the law that is delayed"),
                   {"delay", Form::number, Unit::time, kRequired, "delay; negative: earlier"}}},
                 [](const Params& p) { return laws::shift(p.law("law"), p.number("delay")); });
}

}  // namespace lockstep
