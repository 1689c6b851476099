// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/frame_laws.h>

#include <cmath>
#include <utility>

#include "motionlaws/law_types.h"

namespace lockstep {
namespace {

class ConstantRotation final : public RotationLaw {
 public:
  explicit ConstantRotation(const Quat& q) : q_(require_orientation("constant", "orientation", q)) {}
  RotationValue at(double) const override { return {q_, Vec3::Zero(), Vec3::Zero()}; }
  bool turns_about(const Vec3& axis) const override { return are_parallel(q_.vec(), axis); }

 private:
  Quat q_;
};

class AxisRotation final : public RotationLaw {
 public:
  AxisRotation(const Vec3& axis, LawPtr<MotionLaw> law)
      : axis_(require_direction("axis_rotation", "axis", axis)), law_(std::move(law)) {
    require_law("axis_rotation", "law", law_);
  }
  RotationValue at(double t) const override {
    const LawValue y = law_->at(t);
    return {Quat::from(std::cos(0.5 * y.y), Vec3(std::sin(0.5 * y.y) * axis_)), y.yd * axis_, y.ydd * axis_};
  }
  bool turns_about(const Vec3& axis) const override { return are_parallel(axis_, axis); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override { law_->breakpoints(t0, t1, out); }

 private:
  Vec3 axis_;
  LawPtr<MotionLaw> law_;
};

class RotationProduct final : public RotationLaw {
 public:
  RotationProduct(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second)
      : first_(std::move(first)), second_(std::move(second)) {
    require_law("product", "first", first_);
    require_law("product", "second", second_);
  }
  RotationValue at(double t) const override {
    const RotationValue r1 = first_->at(t), r2 = second_->at(t);
    const Mat3 A2 = rotation(r2.q);
    const Vec3 w1 = A2.transpose() * r1.w;
    return {r1.q * r2.q, w1 + r2.w, A2.transpose() * r1.a + r2.a + cross(w1, r2.w)};
  }
  bool turns_about(const Vec3& axis) const override { return first_->turns_about(axis) && second_->turns_about(axis); }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override {
    first_->breakpoints(t0, t1, out);
    second_->breakpoints(t0, t1, out);
  }

 private:
  LawPtr<RotationLaw> first_, second_;
};

}  // namespace

LawPtr<RotationLaw> laws::constant_rotation(const Quat& orientation) {
  return std::make_shared<const ConstantRotation>(orientation);
}
LawPtr<RotationLaw> laws::axis_rotation(const Vec3& axis, LawPtr<MotionLaw> law) {
  return std::make_shared<const AxisRotation>(axis, std::move(law));
}
LawPtr<RotationLaw> laws::rotation_product(LawPtr<RotationLaw> first, LawPtr<RotationLaw> second) {
  return std::make_shared<const RotationProduct>(std::move(first), std::move(second));
}

void add_rotations(LawTypes& types) {
  types.rotation_laws.add(
      {"constant",
       "a fixed orientation",
       {{"orientation", Form::orientation, Unit::none, kRequired, "the orientation relative to the frame"}}},
      [](const Params& p) { return laws::constant_rotation(p.orientation("orientation")); });
  types.rotation_laws.add({"axis_rotation",
                           "rotation about an axis by a scalar law",
                           {{"axis", Form::axis, Unit::none, kRequired, "direction, in axes of the frame"},
                            value_key("law", Form::law, kRequired, "scalar law of the angle")}},
                          [](const Params& p) { return laws::axis_rotation(p.vector3("axis"), p.law("law")); });
  types.rotation_laws.add(
      {"product",
       "two rotations one after the other, q = q1 q2",
       {value_key("first", Form::rotation_law, kRequired, "q1, relative to the frame"),
        value_key("second", Form::rotation_law, kRequired, "q2, about the axes rotated by q1")}},
      [](const Params& p) { return laws::rotation_product(p.rotation_law("first"), p.rotation_law("second")); });
}

}  // namespace lockstep
