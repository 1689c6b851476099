#include "framework/mechanism/forces/applied.h"

#include "framework/foundation/support/text.h"

namespace lockstep {

Applied::Applied(std::string name, Marker& p, Marker* s, AppliedVector vector, const char* value_key)
    : MarkerForce(std::move(name), p, s), vector_(std::move(vector)) {
  require_finite(value_key, vector_.value);
  require_finite("direction", vector_.direction);
  if (vector_.law) {
    const double length = vector_.direction.norm();
    require(length > 0, "direction", "is [0, 0, 0]; a law acts along a direction, give one");
    vector_.direction /= length;
  }
  add_law(vector_.law);
  for (const LawPtr<MotionLaw>& law : vector_.laws) add_law(law);
}
Applied::~Applied() = default;

void Applied::setup() {
  MarkerForce::setup();
  body_axes_ = rotation(p().body->in_slot.q);
}

Vec3 Applied::in_its_axes(const Inputs& in) const {
  Vec3 f = vector_.value;
  if (vector_.law) f += value(vector_.law, in.t) * vector_.direction;
  for (int k = 0; k < 3; ++k) f[k] += value(vector_.laws[static_cast<std::size_t>(k)], in.t);
  return f;
}

Vec3 Applied::in_world_axes(const Inputs& in) const {
  const Vec3 f = in_its_axes(in);
  switch (vector_.axes) {
    case AppliedAxes::body:
      return in.slot(P_.slot).A * (body_axes_ * f);
    case AppliedAxes::marker:
      return in_world(P_, in).A * f;
    default:
      return f;
  }
}

// (9.14) constant in the world, or fixed in the slot of P
VaryingVector Applied::varying(const Inputs& in, const Variation& at) const {
  const Vec3 f = in_its_axes(in);
  switch (vector_.axes) {
    case AppliedAxes::body:
      return at.fixed(0, body_axes_ * f);
    case AppliedAxes::marker:
      return at.fixed(0, P_.at(in.t).A * f);
    default:
      return {f};
  }
}

Keys Applied::keys(const char* value_key, Unit unit) {
  return {{value_key, Form::vector3, unit, kOptional, "constant part, in the axes of \"axes\""},
          {"law", Form::law, unit, kOptional, "law along \"direction\", added"},
          {"direction", Form::axis, Unit::none, kOptional, "of \"law\", in the axes of \"axes\""},
          {"laws", Form::laws, unit, kOptional, "three laws [x, y, z] of the components, added"},
          {"axes",
           Form::choice,
           Unit::none,
           "world",
           "the axes that these are given in: the world's, those of p's "
           "body, or those of marker p",
           {"world", "body", "marker"}}};
}

AppliedVector Applied::read(const Params& params, const char* value_key) {
  AppliedVector r;
  if (!params.has(value_key) && !params.has("law") && !params.has("laws"))
    params.refuse(value_key,
                  std::string("nothing to apply; give \"") + value_key + "\", \"law\" with \"direction\", or \"laws\"");
  if (params.has(value_key)) r.value = params.vector3(value_key);
  if (params.has("law") != params.has("direction"))
    params.refuse("direction", params.has("law") ? "missing; \"law\" acts along a direction, such as \"x\" or [0, 1, 0]"
                                                 : "given without \"law\", which would act along it; add \"law\"");
  if (params.has("law")) r.law = params.law("law"), r.direction = params.vector3("direction");
  if (params.has("laws")) {
    const std::vector<LawPtr<MotionLaw>> laws = params.laws("laws");
    if (laws.size() != 3) params.refuse("laws", "has " + std::to_string(laws.size()) + " laws; give three: [x, y, z]");
    for (std::size_t k = 0; k < 3; ++k) r.laws[k] = laws[k];
  }
  const std::string axes = params.text("axes");
  r.axes = axes == "body" ? AppliedAxes::body : axes == "marker" ? AppliedAxes::marker : AppliedAxes::world;
  return r;
}

}  // namespace lockstep
