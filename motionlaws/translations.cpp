// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/frame_laws.h>

#include <array>
#include <utility>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class ConstantTranslation final : public TranslationLaw {
 public:
  explicit ConstantTranslation(const Vec3& value) : value_(value) {
    for (const double x : value) require_finite("constant", "value", x);
  }
  TranslationValue at(double) const override { return {value_, Vec3::Zero(), Vec3::Zero()}; }
  bool stays_in_plane(const Vec3&) const override { return true; }

 private:
  Vec3 value_;
};

class ComponentsLaw final : public TranslationLaw {
 public:
  ComponentsLaw(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z)
      : laws_{std::move(x), std::move(y), std::move(z)} {
    constexpr const char* kNames[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) require_law("components", kNames[i], laws_[i]);
  }
  TranslationValue at(double t) const override {
    TranslationValue r;
    for (std::size_t i = 0; i < 3; ++i) {
      const LawValue v = laws_[i]->at(t);
      const auto k = static_cast<Eigen::Index>(i);
      r.x[k] = v.y, r.v[k] = v.yd, r.a[k] = v.ydd;
    }
    return r;
  }
  bool stays_in_plane(const Vec3& normal) const override {
    for (std::size_t i = 0; i < 3; ++i)
      if (!are_perpendicular(Vec3::Unit(static_cast<Eigen::Index>(i)), normal) && !laws_[i]->is_constant())
        return false;
    return true;
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    for (const auto& law : laws_) law->breakpoints(t0, t1, out);
  }

 private:
  std::array<LawPtr<MotionLaw>, 3> laws_;
};

class AlongLaw final : public TranslationLaw {
 public:
  AlongLaw(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin)
      : axis_(require_direction("along", "axis", axis)), origin_(origin), law_(std::move(law)) {
    for (const double x : origin) require_finite("along", "origin", x);
    require_law("along", "law", law_);
  }
  TranslationValue at(double t) const override {
    const LawValue s = law_->at(t);
    return {origin_ + s.y * axis_, s.yd * axis_, s.ydd * axis_};
  }
  bool stays_in_plane(const Vec3& normal) const override {
    return are_perpendicular(normal, axis_) || law_->is_constant();
  }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { law_->breakpoints(t0, t1, out); }

 private:
  Vec3 axis_, origin_;
  LawPtr<MotionLaw> law_;
};

}  // namespace

LawPtr<TranslationLaw> laws::constant_translation(const Vec3& value) {
  return std::make_shared<const ConstantTranslation>(value);
}
LawPtr<TranslationLaw> laws::components(LawPtr<MotionLaw> x, LawPtr<MotionLaw> y, LawPtr<MotionLaw> z) {
  return std::make_shared<const ComponentsLaw>(std::move(x), std::move(y), std::move(z));
}
LawPtr<TranslationLaw> laws::along(const Vec3& axis, LawPtr<MotionLaw> law, const Vec3& origin) {
  return std::make_shared<const AlongLaw>(axis, std::move(law), origin);
}

void add_translations(LawTypes& types) {
  types.translation_laws.add(
      {"constant",
       "x = value",
       {{"value", Form::vector3, Unit::length, kRequired, "the translation, in axes of the frame"}}},
      [](const Params& p) { return laws::constant_translation(p.vector3("value")); });
  types.translation_laws.add({"components",
                              "a scalar law for each component, in axes of the frame",
                              {value_key("x", Form::law, 0, "law of x"), value_key("y", Form::law, 0, "law of y"),
                               value_key("z", Form::law, 0, "law of z")}},
                             [](const Params& p) { return laws::components(p.law("x"), p.law("y"), p.law("z")); });
  types.translation_laws.add(
      {"along",
       "x = origin + axis law(t)",
       {{"axis", Form::axis, Unit::none, kRequired, "direction, in axes of the frame"},
        value_key("law", Form::law, kRequired, "scalar law of the distance"),
        {"origin", Form::vector3, Unit::length, Value::List{0, 0, 0}, "where the distance is zero"}}},
      [](const Params& p) { return laws::along(p.vector3("axis"), p.law("law"), p.vector3("origin")); });
}

}  // namespace lockstep
