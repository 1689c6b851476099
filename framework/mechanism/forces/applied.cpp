// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <lockstep/author/params.h>
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

Applied::Applied(std::string name, Marker& p, Marker* s, Effort effort, AppliedVector vector)
    : FormulaForce(std::move(name), p, s), effort_(effort), vector_(std::move(vector)) {
  require_finite(word(effort_), vector_.value);
  require_finite("direction", vector_.direction);
  if (vector_.law) {
    const double length = vector_.direction.norm();
    require(length > 0, "direction", "is [0, 0, 0]; a law acts along a direction, give one");
    vector_.direction /= length;
  }
  add_law(vector_.law, "law", unit(effort_));
  for (std::size_t k = 0; k < 3; ++k) add_law(vector_.laws[k], std::string("laws_") + "xyz"[k], unit(effort_));
}
Applied::~Applied() = default;

void Applied::setup() {
  if (effort_ == Effort::torque) require_turning(p(), "rotates");
  if (s() != nullptr) require_turning(*s(), effort_ == Effort::torque ? "rotates" : "has a lever arm on");
  MarkerForce::setup();
  body_axes_ = rotation(p().body->in_slot.q);
}

bool Applied::stays_in_plane(Plane plane) const {
  const bool force = effort_ == Effort::force;
  if (!markers_stay_in(plane, false) || (force && !has_no_arms(plane))) return false;
  const Vec3 n = vector_.axes == AppliedAxes::world  ? Vec3(Vec3::Unit(plane.n))
                 : vector_.axes == AppliedAxes::body ? Vec3(body_axes_.row(plane.n))
                                                     : Vec3(P_.A0.row(plane.n));
  const auto fits = [&](const Vec3& direction) {
    const Vec3 along = direction.normalized();
    return force ? are_perpendicular(along, n) : are_parallel(along, n);
  };
  if (!fits(vector_.value) || (vector_.law && !fits(vector_.direction))) return false;
  for (int k = 0; k < 3; ++k)
    if (vector_.laws[k] && !fits(Vec3::Unit(k))) return false;
  return true;
}

std::vector<Quantity> Applied::quantities() const {
  std::vector<Quantity> all;
  for (const char* axis : {"x", "y", "z"})
    all.push_back({std::string(word(effort_)) + "_on_p_world_" + axis, unit(effort_),
                   std::string(word(effort_)) + " on P's body, world axes, " + axis});
  all.push_back(power());
  return all;
}

Vec3 Applied::in_its_axes(double t) const {
  Vec3 f = vector_.value;
  if (vector_.law) f += value(vector_.law, t) * vector_.direction;
  for (int k = 0; k < 3; ++k) f[k] += value(vector_.laws[k], t);
  return f;
}

template <class T, class Load>
void Applied::act(const Ends<T>& at, Load& load) const {
  const Vec3 own = in_its_axes(at.t);
  Vec3T<T> f = own.cast<T>();
  if (vector_.axes == AppliedAxes::body) f = at.P.slot.A * Vec3(body_axes_ * own);
  if (vector_.axes == AppliedAxes::marker) f = at.P.slot.A * Vec3(at.P.marker.A * own);
  exert(effort_, f, at, load);
  load.supplies(f.dot(rate_from_s(effort_, at)));
  load.shows(f);
  if (effort_ != Effort::force || vector_.axes != AppliedAxes::world || S_.slot != kGround) return;
  load.stores(-vector_.value.dot(at.P.x()));  // the constant part
  load.supplies(-vector_.value.dot(at.P.v()));
}

namespace {

Keys keys(Effort effort) {
  const Unit unit = effort == Effort::force ? Unit::force : Unit::torque;
  return {{word(effort), Form::vector3, unit, kOptional, "constant part, in the axes given by \"axes\""},
          {"law", Form::law, unit, kOptional, "part by a law along \"direction\", added"},
          {"direction", Form::axis, Unit::none, kOptional, "direction of \"law\", in the axes given by \"axes\""},
          {"laws", Form::laws, unit, kOptional, "part by three laws [x, y, z], added"},
          {"axes",
           Form::choice,
           Unit::none,
           "world",
           "axes in which these are given: the world's, those of p's "
           "body, or those of marker p",
           {"world", "body", "marker"}}};
}

AppliedVector read(Effort effort, const Params& params) {
  const char* const value_key = word(effort);
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

// Of an AppliedForce or an AppliedTorque.
template <class Options>
AppliedVector vector_of(Options o) {
  auto& [value, law, direction, laws, axes] = o;
  return {value, std::move(law), direction, std::move(laws), axes};
}

}  // namespace

AppliedForce::AppliedForce(std::string name, Marker& p, Options options)
    : Applied(std::move(name), p, nullptr, Effort::force, vector_of(std::move(options))) {}
AppliedForce::AppliedForce(std::string name, Marker& p, Marker& s, Options options)
    : Applied(std::move(name), p, &s, Effort::force, vector_of(std::move(options))) {}

TypeInfo AppliedForce::info() {
  return {"applied_force", "force at the origin of p on p's body; with s, the opposite on s's body at the same point",
          keys(Effort::force)};
}

std::unique_ptr<Force> AppliedForce::make(const Attachment& attachment, const Params& k) {
  AppliedVector v = read(Effort::force, k);
  const Options o{v.value, std::move(v.law), v.direction, std::move(v.laws), v.axes};
  if (!has_s(attachment)) return std::make_unique<AppliedForce>(attachment.name, p_of(attachment, k), o);
  return std::make_unique<AppliedForce>(attachment.name, p_of(attachment, k), s_of(attachment, k), o);
}

AppliedTorque::AppliedTorque(std::string name, Marker& p, Options options)
    : Applied(std::move(name), p, nullptr, Effort::torque, vector_of(std::move(options))) {}
AppliedTorque::AppliedTorque(std::string name, Marker& p, Marker& s, Options options)
    : Applied(std::move(name), p, &s, Effort::torque, vector_of(std::move(options))) {}

TypeInfo AppliedTorque::info() {
  return {"applied_torque", "torque on p's body; with s, the opposite on s's body", keys(Effort::torque)};
}

std::unique_ptr<Force> AppliedTorque::make(const Attachment& attachment, const Params& k) {
  AppliedVector v = read(Effort::torque, k);
  const Options o{v.value, std::move(v.law), v.direction, std::move(v.laws), v.axes};
  if (!has_s(attachment)) return std::make_unique<AppliedTorque>(attachment.name, p_of(attachment, k), o);
  return std::make_unique<AppliedTorque>(attachment.name, p_of(attachment, k), s_of(attachment, k), o);
}

template class FormulaForce<Applied>;

}  // namespace lockstep
