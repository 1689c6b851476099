// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include <lockstep/author/force.h>
#include <lockstep/author/params.h>
#include <lockstep/author/relative.h>
#include <lockstep/text.h>
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

namespace {

[[noreturn]] void refuse_friction(const Force& force, const Lock& link, const std::string& why) {
  throw ModelError("force '" + force.name() + "': joint '" + link.name() + "' (" + std::string(link.type()) + ") " +
                   why + "; use joints such as revolute, prismatic, cylindrical, point_on_plane");
}

}  // namespace

/// The loads on the rubbing surfaces, N: normal to the sliding, radial and axial to the turning. All zero while the
/// joint is not in force.
struct JointFriction::Pressing {
  bool in_force = false;
  double normal = 0, radial = 0, axial = 0;
};

JointFriction::JointFriction(std::string name, const Lock& link, Options options)
    : Force(std::move(name)), Reacting(static_cast<const Force&>(*this)), link_(&link), options_(options) {
  const Jointed* joint = link.jointed();
  if (joint == nullptr) refuse_friction(*this, link, "is not a joint of two markers");
  std::tie(p_, s_) = link.pairs().front();
  check_numbers();
  const Mask mask = joint->mask();
  Vec3 held = Vec3::Zero();
  int n_free_turns = 0;
  for (int k = 0; k < 3; ++k) {
    held[k] = includes(mask, row_bit(k)) ? 1 : 0;
    if (!includes(mask, row_bit(3 + k))) turning_ = k, ++n_free_turns;
  }
  if (n_free_turns != 1 || held.isZero(0)) turning_ = -1;
  if (!held.isZero(0)) sliding_ = Vec3::Ones() - held, pressing_ = held;
  if (sliding_.sum() == 1)
    for (int k = 0; k < 3; ++k) bending_[k] = includes(mask, row_bit(3 + k)) ? 1 - sliding_[k] : 0;
  if (turning_ >= 0) axial_[turning_] = held[turning_], radial_ = held - axial_;
  arm_ = options_.radius > 0 ? options_.radius : options_.axial_radius;
  if (sliding_.isZero(0) && turning_ < 0)
    refuse_friction(*this, link, "has no free direction or axis on which its reaction causes friction");
  if (sliding_.isZero(0) && arm_ == 0 && options_.viscous_turn == 0)
    throw ParameterError({.kind = "force", .name = this->name()}, "radius",
                         "is missing; joint '" + link.name() + "' only rotates, so give its friction radius");
}

void JointFriction::check_numbers() const {
  const auto must = [&](bool ok, const char* key, double value, const char* limit) {
    if (!ok || !std::isfinite(value))
      throw ParameterError({.kind = "force", .name = name()}, key,
                           "is " + text::number(value) + "; must be a finite number, " + limit);
  };
  const Options& o = options_;
  must(o.mu >= 0, "mu", o.mu, "0 or more");
  must(o.mu_static < 0 || o.mu_static >= o.mu, "mu_static", o.mu_static, "not less than mu");
  must(o.stribeck_speed > 0, "stribeck_speed", o.stribeck_speed, "above zero");
  must(o.smoothing_speed > 0, "smoothing_speed", o.smoothing_speed, "above zero");
  must(o.radius >= 0, "radius", o.radius, "0 or more");
  must(o.axial_radius >= 0, "axial_radius", o.axial_radius, "0 or more");
  must(o.bending_length >= 0, "bending_length", o.bending_length, "0 or more");
  must(o.preload >= 0, "preload", o.preload, "0 or more");
  must(o.viscous >= 0, "viscous", o.viscous, "0 or more");
  must(o.viscous_turn >= 0, "viscous_turn", o.viscous_turn, "0 or more");
  must(o.load_smoothing >= 0, "load_smoothing", o.load_smoothing, "0 or more");
}

TypeInfo JointFriction::info() {
  return {
      "joint_friction",
      "dry and viscous friction in a joint, from its reaction at the same time",
      {{"mu", Form::number, Unit::none, kRequired, "coefficient of sliding friction"},
       {"mu_static", Form::number, Unit::none, kOptional, "coefficient at rest (Stribeck); default: mu"},
       {"stribeck_speed", Form::number, Unit::speed, 0.01, "speed over which the coefficient falls to mu"},
       {"smoothing_speed", Form::number, Unit::speed, 0.001,
        "speed at which friction reaches tanh(1) of its full value"},
       {"radius", Form::number, Unit::length, 0, "friction radius of a rotating joint under its radial load"},
       {"axial_radius", Form::number, Unit::length, 0, "friction radius of a rotating joint under its axial load"},
       {"bending_length", Form::number, Unit::length, kOptional,
        "a bending moment M on a sliding joint adds the normal force M/length; usually half the length of the guide"},
       {"preload", Form::number, Unit::force, 0, "normal (radial) force that always acts"},
       {"viscous", Form::number, Unit::damping, 0, "viscous friction of sliding"},
       {"viscous_turn", Form::number, Unit::torsion_damping, 0, "viscous friction of rotation"},
       {"load_smoothing", Form::number, Unit::force, 1e-6, "load below which its magnitude is smoothed"}}};
}

JointFriction::Options JointFriction::options(const Params& k) {
  Options o;
  o.mu = k.number("mu");
  if (k.has("mu_static")) {
    o.mu_static = k.number("mu_static");
    if (o.mu_static < 0) k.refuse("mu_static", "is " + text::number(o.mu_static) + "; must be mu or more");
  }
  o.stribeck_speed = k.number("stribeck_speed"), o.smoothing_speed = k.number("smoothing_speed");
  o.radius = k.number("radius"), o.axial_radius = k.number("axial_radius");
  if (k.has("bending_length")) o.bending_length = k.number("bending_length");
  o.preload = k.number("preload"), o.viscous = k.number("viscous"), o.viscous_turn = k.number("viscous_turn");
  o.load_smoothing = k.number("load_smoothing");
  return o;
}

std::unique_ptr<Force> JointFriction::make(const Attachment& attachment, const Params& k) {
  return std::make_unique<JointFriction>(attachment.name, attachment.carrier(), options(k));
}

void JointFriction::setup() {
  if (link_->row_count() != count_rows(link_->jointed()->rows()))
    refuse_friction(*this, *link_, "also holds a function, whose contact surfaces are not known");
  for (const Marker* m : {p_, s_})
    if (m->translation_law || m->rotation_law)
      throw ModelError("force '" + name() + "': marker '" + m->name + "' of joint '" + link_->name() +
                       "' moves on its body by a law, which friction does not support; drive the joint instead");
  if (link_->jointed()->turned())
    throw ModelError(
        "force '" + name() + "': joint '" + link_->name() +
        "' has a law \"turn\", which rotates its free axis away from z of S; friction does not support that: "
        "rotate the marker instead, or drive the joint");
  P_ = MarkerFrame(*p_), S_ = MarkerFrame(*s_);
}

double JointFriction::size(double square) const {
  const double e = options_.load_smoothing;
  return std::sqrt(square + e * e) - e;
}

// mu(s)/s as a function of s^2; near rest by the first terms of its series.
template <class T>
T JointFriction::coefficient(const T& s2) const {
  using std::exp, std::sqrt, std::tanh;
  const double v0 = options_.smoothing_speed, vs = options_.stribeck_speed;
  const double d = options_.mu_static >= 0 ? options_.mu_static - options_.mu : 0.0;
  if (s2 < 1e-8 * v0 * v0) {
    const double at_rest = options_.mu + d;
    return at_rest / v0 - (at_rest / (3 * v0 * v0) + d / (vs * vs)) / v0 * s2;
  }
  const T s = sqrt(s2);
  return (options_.mu + d * exp(-s2 / (vs * vs))) * tanh(s / v0) / s;
}

JointFriction::Pressing JointFriction::pressing(const Inputs& in, const Reactions& reactions) const {
  if (!reactions.in_force(*link_)) return {};
  Pressing r{true};
  const Mat3 A = MarkerOn<double>{in.slot(S_.slot), S_.at(in.t)}.A();
  const LinkWrench wrench = reactions.on_body_of(P_, *link_, in);
  const Vec3 F = A.transpose() * wrench.force, M = A.transpose() * wrench.moment;
  const Options& o = options_;
  r.normal = o.preload + size(pressing_.cwiseProduct(F).squaredNorm());
  if (o.bending_length > 0) r.normal += size(bending_.cwiseProduct(M).squaredNorm()) / o.bending_length;
  r.radial = o.preload + size(radial_.cwiseProduct(F).squaredNorm());
  r.axial = size(axial_.cwiseProduct(F).squaredNorm());
  return r;
}

// The loads are constants here: the rows are in S axes, so a reaction with fixed multipliers turns with S.
template <class T, class Load>
void JointFriction::act(const Pressing& by, const Ends<T>& at, Load& load) const {
  using V = Vec3T<T>;
  const Options& o = options_;
  if (!sliding_.isZero(0)) {
    const Mat3T<T> A = at.S.A();
    const V x = at.P.x(), v = at.P.v() - at.S.slot_velocity(x), u = sliding_.cwiseProduct(V(A.transpose() * v));
    const T friction = by.in_force ? T(by.normal * coefficient(T(u.dot(u))) + o.viscous) : T(0);
    const V F = -friction * u;
    load.force(A * F, x);
    load.dissipates(-F.dot(u));
    const bool one = sliding_.sum() == 1;
    load.shows(T(by.normal), T(one ? F.sum() : norm(F)), T(one ? u.sum() : norm(u)));
  }
  if (turning_ >= 0) {
    const V axis = at.S.axis(turning_);
    const T rate = axis.dot(at.P.w() - at.S.w());
    const double grip = arm_ * (o.radius * by.radial + o.axial_radius * by.axial);
    const T friction = by.in_force ? T(grip * coefficient(T(arm_ * arm_ * rate * rate)) + o.viscous_turn) : T(0);
    const T torque = -friction * rate;
    load.torque(torque * axis);
    load.dissipates(-torque * rate);
    load.shows(T(by.radial), T(by.axial), torque, rate);
  }
}

void JointFriction::react(const Inputs& in, const Reactions& reactions, WrenchSum& out) const {
  if (const Pressing by = pressing(in, reactions); by.in_force)
    formula::apply(
        P_, S_, in, [&](const auto& at, auto& load) { act(by, at, load); }, out);
}

void JointFriction::react_tangent(const Inputs& in, const Reactions& reactions, TangentSum& out) const {
  if (const Pressing by = pressing(in, reactions); by.in_force)
    formula::tangent(
        P_, S_, in, [&](const auto& at, auto& load) { act(by, at, load); }, out);
}

ForceAccount JointFriction::account(const Inputs& in, const Reactions& reactions) const {
  const Pressing by = pressing(in, reactions);
  return formula::account(P_, S_, in, [&](const auto& at, auto& load) { act(by, at, load); });
}

std::vector<Grip> JointFriction::grips(const Inputs& in, const Reactions& reactions) const {
  const Pressing by = pressing(in, reactions);
  const double mu = std::max(options_.mu, options_.mu_static);
  if (!by.in_force || mu == 0) return {};
  const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
  const int p = p_->body->slot, s = s_->body->slot;
  const auto new_load = [&] { return VecX(VecX::Zero(6 * (static_cast<Eigen::Index>(in.motions.size()) - 1))); };
  std::vector<Grip> all;
  if (!sliding_.isZero(0)) all.push_back({"sliding", "N", mu * by.normal, {}});
  for (int k = 0; k < 3; ++k) {
    if (sliding_[k] == 0) continue;
    const Vec3 F = S.A.col(k);
    all.back().along.push_back(new_load());
    const WrenchSum sum(in.motions, all.back().along.back());
    sum.force(p, F, P.x), sum.force(s, -F, P.x);
  }
  if (turning_ < 0) return all;
  all.push_back(
      {"turning", "N m", mu * (options_.radius * by.radial + options_.axial_radius * by.axial), {new_load()}});
  const WrenchSum sum(in.motions, all.back().along.back());
  sum.torque(p, S.A.col(turning_)), sum.torque(s, -S.A.col(turning_));
  return all;
}

double JointFriction::friction_loss(const Inputs& in, const Reactions& reactions) const {
  return account(in, reactions).dissipation;
}

double JointFriction::reacting_quantity(int k, const Inputs& in, const Reactions& reactions) const {
  return account(in, reactions).shown[k];
}

std::vector<Quantity> JointFriction::quantities() const {
  std::vector<Quantity> all;
  if (!sliding_.isZero(0))
    all = {{"normal_force", "N", "load normal to the sliding"},
           {"friction_force", "N", "friction on P's body, opposite to the sliding; of two directions its magnitude"},
           {"sliding_speed", "m/s", "velocity of P relative to S; of two directions its magnitude"}};
  if (turning_ >= 0)
    for (const Quantity& q : {Quantity{"radial_force", "N", "radial load"}, Quantity{"axial_force", "N", "axial load"},
                              Quantity{"friction_torque", "N m", "friction on P's body, opposite to the rotation"},
                              Quantity{"turning_rate", "rad/s", "angular velocity of P relative to S"}})
      all.push_back(q);
  return all;
}

}  // namespace lockstep
