// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/frame_laws.h>

#include <utility>

#include <lockstep/laws.h>

namespace lockstep {

ConstantTranslation::ConstantTranslation(const Vec3& value) : value_(value) {
  for (const double x : value) require_finite("constant", "value", x);
}

TranslationValue ConstantTranslation::at(double) const { return {value_, Vec3::Zero(), Vec3::Zero()}; }
bool ConstantTranslation::stays_in_plane(const Vec3&) const { return true; }

ComponentsLaw::ComponentsLaw(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z)
    : laws_{std::move(x), std::move(y), std::move(z)} {
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) require_law("components", kNames[i], laws_[i]);
}

TranslationValue ComponentsLaw::at(double t) const {
  TranslationValue r;
  for (std::size_t i = 0; i < 3; ++i) {
    const LawValue v = laws_[i]->at(t);
    const auto k = static_cast<Eigen::Index>(i);
    r.x[k] = v.y, r.v[k] = v.yd, r.a[k] = v.ydd;
  }
  return r;
}

bool ComponentsLaw::stays_in_plane(const Vec3& normal) const {
  for (std::size_t i = 0; i < 3; ++i)
    if (!are_perpendicular(Vec3::Unit(static_cast<Eigen::Index>(i)), normal) && !laws_[i]->is_constant()) return false;
  return true;
}

void ComponentsLaw::breakpoints(double t0, double t1, std::vector<double>& out) const {
  for (const auto& law : laws_) law->breakpoints(t0, t1, out);
}

AlongLaw::AlongLaw(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin)
    : axis_(require_direction("along", "axis", axis)), origin_(origin), law_(std::move(law)) {
  for (const double x : origin) require_finite("along", "origin", x);
  require_law("along", "law", law_);
}

TranslationValue AlongLaw::at(double t) const {
  const LawValue s = law_->at(t);
  return {origin_ + s.y * axis_, s.yd * axis_, s.ydd * axis_};
}

bool AlongLaw::stays_in_plane(const Vec3& normal) const {
  return are_perpendicular(normal, axis_) || law_->is_constant();
}

void AlongLaw::breakpoints(double t0, double t1, std::vector<double>& out) const { law_->breakpoints(t0, t1, out); }

const TypeInfo& ConstantTranslation::info() {
  static const TypeInfo info{
      "constant", "x = value", {{"value", Form::vector3, Unit::length, kRequired, "the translation, in axes of the frame"}}};
  return info;
}

const TypeInfo& ComponentsLaw::info() {
  static const TypeInfo info{"components",
                             "a scalar law for each component, in axes of the frame",
                             {{"x", Form::law, Unit::none, 0, "law of x", {}, LawQuantity::value},
                              {"y", Form::law, Unit::none, 0, "law of y", {}, LawQuantity::value},
                              {"z", Form::law, Unit::none, 0, "law of z", {}, LawQuantity::value}}};
  return info;
}

const TypeInfo& AlongLaw::info() {
  static const TypeInfo info{
      "along",
      "x = origin + axis law(t)",
      {{"axis", Form::axis, Unit::none, kRequired, "direction, in axes of the frame"},
       {"law", Form::law, Unit::none, kRequired, "scalar law of the distance", {}, LawQuantity::value},
       {"origin", Form::vector3, Unit::length, Value::List{0, 0, 0}, "where the distance is zero"}}};
  return info;
}

LawPtr<TranslationLaw> ConstantTranslation::make(const Params& p) {
  return laws::constant_translation(p.vector3("value"));
}

LawPtr<TranslationLaw> ComponentsLaw::make(const Params& p) {
  return laws::components(p.law("x"), p.law("y"), p.law("z"));
}

LawPtr<TranslationLaw> AlongLaw::make(const Params& p) {
  return laws::along(p.vector3("axis"), p.law("law"), p.vector3("origin"));
}

namespace laws {
LawPtr<TranslationLaw> constant_translation(const Vec3& value) {
  return std::make_shared<const ConstantTranslation>(value);
}
LawPtr<TranslationLaw> components(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z) {
  return std::make_shared<const ComponentsLaw>(std::move(x), std::move(y), std::move(z));
}
LawPtr<TranslationLaw> along(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin) {
  return std::make_shared<const AlongLaw>(axis, std::move(law), origin);
}
}  // namespace laws

}  // namespace lockstep
