// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/force.h>

#include <cmath>

#include <lockstep/author/params.h>
#include <lockstep/author/relative.h>
#include <lockstep/body.h>
#include <lockstep/text.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {
void require_body(const std::string& force, const Marker& m) {
  if (m.body == nullptr)
    throw ModelError("force '" + force + "': marker '" + m.name + "' is not on a body; add it with add_marker");
}

// Along the normal: of a marker as its law puts it, and of the centre of mass of its slot, which has the world's axes.
struct Height {
  double marker, center, rounding;
};

Height height_of(const Marker& m, const MarkerFrame& frame, Plane plane) {
  const Vec3 x = (m.body->home * m.local).x;
  const double center = x[plane.n] - frame.u0[plane.n];
  return {center + frame.at(0).u[plane.n], center, kRoundOff * x.norm() + 1e-15};
}
}  // namespace

MarkerForce::MarkerForce(std::string name, Marker& p, Marker* s) : Force(std::move(name)), p_(&p), s_(s) {
  require_body(this->name(), p);
  if (s == nullptr) return;
  require_body(this->name(), *s);
  if (p.body == s->body)
    throw ModelError("force '" + this->name() + "': both markers are on body '" + p.body->name +
                     "', so action and reaction cancel; put P or S on another body");
}
MarkerForce::~MarkerForce() = default;

std::vector<const Marker*> MarkerForce::markers() const {
  if (s_ == nullptr) return {p_};
  return {p_, s_};
}

bool MarkerForce::has_no_arms(Plane plane) const {
  const Height P = height_of(*p_, P_, plane), S = s_ ? height_of(*s_, S_, plane) : P;
  const auto is_level = [&](double y) { return std::abs(P.marker - y) <= P.rounding + S.rounding; };
  return (P_.slot == kGround || is_level(P.center)) && (S_.slot == kGround || is_level(S.center));
}

bool MarkerForce::markers_stay_in(Plane plane, bool pushes) const {
  if (!P_.stays_in_plane(plane) || !S_.stays_in_plane(plane)) return false;
  if (!pushes) return true;
  const Height P = height_of(*p_, P_, plane), S = s_ ? height_of(*s_, S_, plane) : P;
  return has_no_arms(plane) && std::abs(P.marker - S.marker) <= P.rounding + S.rounding;
}

void MarkerForce::breakpoints(double t0, double t1, std::vector<double>& out) const {
  MarkerFrame(*p_).breakpoints(t0, t1, out);
  if (s_ != nullptr) MarkerFrame(*s_).breakpoints(t0, t1, out);
  for (const ForceLaw& own : laws_) own.law->breakpoints(t0, t1, out);
}

std::string MarkerForce::diagnose(double t) const {
  for (const ForceLaw& own : laws_)
    if (std::string f = law_fault("its law", own.law, t); !f.empty()) return f;
  std::string at_p = marker_fault(*p_, t);
  return at_p.empty() && s_ != nullptr ? marker_fault(*s_, t) : at_p;
}

void MarkerForce::setup() {
  P_ = MarkerFrame(*p_);
  S_ = s_ != nullptr ? MarkerFrame(*s_) : MarkerFrame();
}

void MarkerForce::require(bool ok, const char* key, const std::string& problem) const {
  if (!ok) throw ParameterError({.kind = "force", .name = name()}, key, problem);
}
void MarkerForce::require_finite(const char* key, double value) const {
  require(std::isfinite(value), key, "is " + text::number(value) + "; must be a finite number");
}
void MarkerForce::require_finite(const char* key, const Vec3& value) const {
  require(value.allFinite(), key,
          "is [" + text::number(value[0]) + ", " + text::number(value[1]) + ", " + text::number(value[2]) +
              "]; must be finite numbers");
}
void MarkerForce::require_not_negative(const char* key, double value) const {
  require(std::isfinite(value) && value >= 0, key,
          "is " + text::number(value) + "; must be a finite number, 0 or more");
}

void MarkerForce::require_turning(const Marker& m, const char* does) const {
  if (m.body->freedoms != Freedoms::particle) return;
  throw ModelError("force '" + name() + "' (" + std::string(type()) + ") " + does + " body '" + m.body->name +
                   "' at marker '" + m.name + "', but '" + m.body->name +
                   "' is a particle and cannot rotate; give it an inertia (add_body), or use another body");
}

void MarkerForce::add_law(const LawPtr<MotionLaw>& law, std::string what, std::string unit) {
  if (law) laws_.push_back({std::move(what), std::move(unit), law});
}

Marker& p_of(const Attachment& attachment, const Params& params) {
  if (attachment.pairs.empty() || attachment.pairs.front().first == nullptr)
    params.refuse("p", "missing; name the marker or body that the force acts on");
  return attachment.p();
}
Marker& s_of(const Attachment& attachment, const Params& params) {
  if (!has_s(attachment))
    params.refuse("s", "missing; name the marker or body that takes the reaction, such as \"ground\"");
  return attachment.s();
}
bool has_s(const Attachment& attachment) {
  return !attachment.pairs.empty() && attachment.pairs.front().second != nullptr;
}

}  // namespace lockstep
