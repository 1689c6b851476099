// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/laws.h>

#include <utility>

namespace lockstep {
namespace {

void require_laws(const char* law, const std::vector<LawPtr<MotionLaw>>& laws) {
  require(!laws.empty(), law, "laws", "are missing; give at least one");
  for (const auto& inner : laws) require_law(law, "laws", inner);
}

void breakpoints_of(const std::vector<LawPtr<MotionLaw>>& laws, double t0, double t1, std::vector<double>& out) {
  for (const auto& law : laws) law->breakpoints(t0, t1, out);
}

}  // namespace

SumLaw::SumLaw(std::vector<LawPtr<MotionLaw>> laws) : laws_(std::move(laws)) { require_laws("sum", laws_); }

LawValue SumLaw::at(double t) const {
  LawValue r;
  for (const auto& law : laws_) {
    const LawValue v = law->at(t);
    r.y += v.y, r.yd += v.yd, r.ydd += v.ydd;
  }
  return r;
}

void SumLaw::breakpoints(double t0, double t1, std::vector<double>& out) const { breakpoints_of(laws_, t0, t1, out); }

ProductLaw::ProductLaw(std::vector<LawPtr<MotionLaw>> laws) : laws_(std::move(laws)) { require_laws("product", laws_); }

LawValue ProductLaw::at(double t) const {
  LawValue r{1.0, 0.0, 0.0};
  for (const auto& law : laws_) {
    const LawValue v = law->at(t);
    r = {r.y * v.y, r.yd * v.y + r.y * v.yd, r.ydd * v.y + 2.0 * r.yd * v.yd + r.y * v.ydd};
  }
  return r;
}

void ProductLaw::breakpoints(double t0, double t1, std::vector<double>& out) const {
  breakpoints_of(laws_, t0, t1, out);
}

ScaledLaw::ScaledLaw(LawPtr<MotionLaw> law, double factor, double offset)
    : law_(std::move(law)), factor_(factor), offset_(offset) {
  require_law("scale", "law", law_);
  require_finite("scale", "factor", factor);
  require_finite("scale", "offset", offset);
}

LawValue ScaledLaw::at(double t) const {
  const LawValue v = law_->at(t);
  return {offset_ + factor_ * v.y, factor_ * v.yd, factor_ * v.ydd};
}

void ScaledLaw::breakpoints(double t0, double t1, std::vector<double>& out) const {
  if (factor_ != 0.0) law_->breakpoints(t0, t1, out);
}

ShiftedLaw::ShiftedLaw(LawPtr<MotionLaw> law, double delay) : law_(std::move(law)), delay_(delay) {
  require_law("shift", "law", law_);
  require_finite("shift", "delay", delay);
}

LawValue ShiftedLaw::at(double t) const { return law_->at(t - delay_); }

void ShiftedLaw::breakpoints(double t0, double t1, std::vector<double>& out) const {
  const std::size_t n = out.size();
  law_->breakpoints(t0 - delay_, t1 - delay_, out);
  for (std::size_t i = n; i < out.size(); ++i) out[i] += delay_;
}

const TypeInfo& SumLaw::info() {
  static const TypeInfo info{"sum",
                             "y = y_1 + y_2 + ...",
                             {{"laws", Form::laws, Unit::none, kRequired, "the addends", {}, LawQuantity::value}}};
  return info;
}

const TypeInfo& ProductLaw::info() {
  static const TypeInfo info{
      "product", "y = y_1 y_2 ...", {{"laws", Form::laws, Unit::none, kRequired, "the factors"}}};
  return info;
}

const TypeInfo& ScaledLaw::info() {
  static const TypeInfo info{"scale",
                             "y = offset + factor law(t)",
                             {{"law", Form::law, Unit::none, kRequired, "the law that is scaled"},
                              {"factor", Form::number, Unit::any, 1, "what its value is multiplied by"},
                              {"offset", Form::number, Unit::any, 0, "what is added then", {}, LawQuantity::value}}};
  return info;
}

const TypeInfo& ShiftedLaw::info() {
  static const TypeInfo info{
      "shift",
      "y(t) = law(t - delay)",
      {{"law", Form::law, Unit::none, kRequired, "the law that is delayed", {}, LawQuantity::value},
       {"delay", Form::number, Unit::time, kRequired, "by how much; negative: earlier"}}};
  return info;
}

LawPtr<MotionLaw> SumLaw::make(const Params& p) {
  return laws::sum(p.laws("laws"));
}

LawPtr<MotionLaw> ProductLaw::make(const Params& p) {
  return laws::product(p.laws("laws"));
}

LawPtr<MotionLaw> ScaledLaw::make(const Params& p) {
  return laws::scale(p.law("law"), p.number("factor"), p.number("offset"));
}

LawPtr<MotionLaw> ShiftedLaw::make(const Params& p) {
  return laws::shift(p.law("law"), p.number("delay"));
}

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

}  // namespace lockstep
