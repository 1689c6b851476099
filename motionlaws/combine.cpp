// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <utility>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

// What sum and product have in common.
class OfLaws : public MotionLaw {
 public:
  OfLaws(const char* type, std::vector<LawPtr<MotionLaw>> laws) : laws_(std::move(laws)) {
    require(!laws_.empty(), type, "laws", "are missing; give at least one");
    for (const auto& law : laws_) require_law(type, "laws", law);
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const final {
    for (const auto& law : laws_) law->breakpoints(t0, t1, out);
  }

 protected:
  std::vector<LawPtr<MotionLaw>> laws_;
};

class SumLaw final : public OfLaws {
 public:
  explicit SumLaw(std::vector<LawPtr<MotionLaw>> laws) : OfLaws("sum", std::move(laws)) {}
  LawValue at(double t) const override {
    LawValue r;
    for (const auto& law : laws_) {
      const LawValue v = law->at(t);
      r.y += v.y, r.yd += v.yd, r.ydd += v.ydd;
    }
    return r;
  }
};

class ProductLaw final : public OfLaws {
 public:
  explicit ProductLaw(std::vector<LawPtr<MotionLaw>> laws) : OfLaws("product", std::move(laws)) {}
  LawValue at(double t) const override {
    LawValue r{1.0, 0.0, 0.0};
    for (const auto& law : laws_) {
      const LawValue v = law->at(t);
      r = {r.y * v.y, r.yd * v.y + r.y * v.yd, r.ydd * v.y + 2.0 * r.yd * v.yd + r.y * v.ydd};
    }
    return r;
  }
};

class ScaledLaw final : public MotionLaw {
 public:
  ScaledLaw(LawPtr<MotionLaw> law, double factor, double offset)
      : law_(std::move(law)), factor_(factor), offset_(offset) {
    require_law("scale", "law", law_);
    require_finite("scale", "factor", factor);
    require_finite("scale", "offset", offset);
  }
  LawValue at(double t) const override {
    const LawValue v = law_->at(t);
    return {offset_ + factor_ * v.y, factor_ * v.yd, factor_ * v.ydd};
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    if (factor_ != 0.0) law_->breakpoints(t0, t1, out);
  }

 private:
  LawPtr<MotionLaw> law_;
  double factor_, offset_;
};

class ShiftedLaw final : public MotionLaw {
 public:
  ShiftedLaw(LawPtr<MotionLaw> law, double delay) : law_(std::move(law)), delay_(delay) {
    require_law("shift", "law", law_);
    require_finite("shift", "delay", delay);
  }
  LawValue at(double t) const override { return law_->at(t - delay_); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    const std::size_t n = out.size();
    law_->breakpoints(t0 - delay_, t1 - delay_, out);
    for (std::size_t i = n; i < out.size(); ++i) out[i] += delay_;
  }

 private:
  LawPtr<MotionLaw> law_;
  double delay_;
};

}  // namespace

namespace laws {
LawPtr<MotionLaw> sum(std::vector<LawPtr<MotionLaw>> laws) { return std::make_shared<const SumLaw>(std::move(laws)); }
LawPtr<MotionLaw> product(std::vector<LawPtr<MotionLaw>> laws) {
  return std::make_shared<const ProductLaw>(std::move(laws));
}
LawPtr<MotionLaw> scale(LawPtr<MotionLaw> law, double factor, double offset) {
  return std::make_shared<const ScaledLaw>(std::move(law), factor, offset);
}
LawPtr<MotionLaw> shift(LawPtr<MotionLaw> law, double delay) {
  return std::make_shared<const ShiftedLaw>(std::move(law), delay);
}
}  // namespace laws

void add_combine(LawTypes& types) {
  types.laws.add({"sum",
                  "y = y_1 + y_2 + ...",
                  {{"laws", Form::laws, Unit::none, kRequired, "the addends", {}, LawQuantity::value}}},
                 [](const Params& p) { return laws::sum(p.laws("laws")); });
  types.laws.add({"product", "y = y_1 y_2 ...", {{"laws", Form::laws, Unit::none, kRequired, "the factors"}}},
                 [](const Params& p) { return laws::product(p.laws("laws")); });
  types.laws.add({"scale",
                  "y = offset + factor law(t)",
                  {{"law", Form::law, Unit::none, kRequired, "the law that is scaled"},
                   {"factor", Form::number, Unit::any, 1, "factor of its value"},
                   {"offset", Form::number, Unit::any, 0, "added to the product", {}, LawQuantity::value}}},
                 [](const Params& p) { return laws::scale(p.law("law"), p.number("factor"), p.number("offset")); });
  types.laws.add({"shift",
                  "y(t) = law(t - delay)",
                  {{"law", Form::law, Unit::none, kRequired, "the law that is delayed", {}, LawQuantity::value},
                   {"delay", Form::number, Unit::time, kRequired, "delay; negative: earlier"}}},
                 [](const Params& p) { return laws::shift(p.law("law"), p.number("delay")); });
}

}  // namespace lockstep
