#include "framework/mechanism/forces/joint_friction.h"

#include <cmath>
#include <tuple>

#include "framework/mechanism/forces/marker_force.h"
#include "framework/mechanism/forces/variation.h"
#include "framework/foundation/support/text.h"

namespace lockstep {

/// f(s)/s for s >= 0, and d(f/s)/ds / s, both finite at rest.
struct JointFriction::Slope {
  double over_speed, bend;
};

/// What rubs at one instant, S axes.
struct JointFriction::Rubbing {
  Mat3 A;         ///< S axes -> world
  Vec3 point, u;  ///< origin of P in the world; sliding velocity
  double normal = 0, radial = 0, axial = 0, rate = 0;
  Vec3 force = Vec3::Zero();  ///< on P's body
  double torque = 0;          ///< on P's body about the free axis
  bool in_force = false;
};

JointFriction::JointFriction(std::string name, const Lock& link, Options options)
    : Force(std::move(name)), link_(&link), options_(options) {
  const Jointed* joint = link.jointed();
  const std::string who =
      "force '" + this->name() + "': link '" + link.name() + "' (" + std::string(link.type()) + ") ";
  if (joint == nullptr)
    throw ModelError(who +
                     "is no lock of two markers; friction is there in joints such as revolute, prismatic, "
                     "cylindrical, point_on_plane");
  std::tie(p_, s_) = link.pairs().front();
  check_numbers();
  const Mask mask = joint->mask();
  Vec3 held = Vec3::Zero();
  int n_free_turns = 0;
  for (int k = 0; k < 3; ++k) {
    held[k] = has(mask, row_bit(k)) ? 1 : 0;
    if (!has(mask, row_bit(3 + k))) turning_ = k, ++n_free_turns;
  }
  if (n_free_turns != 1 || held.isZero(0)) turning_ = -1;
  if (!held.isZero(0)) sliding_ = Vec3::Ones() - held, pressing_ = held;
  if (sliding_.sum() == 1)
    for (int k = 0; k < 3; ++k) bending_[k] = has(mask, row_bit(3 + k)) ? 1 - sliding_[k] : 0;
  if (turning_ >= 0) axial_[turning_] = held[turning_], radial_ = held - axial_;
  arm_ = options_.radius > 0 ? options_.radius : options_.axial_radius;
  if (sliding_.isZero(0) && turning_ < 0)
    throw ModelError(who +
                     "has no free direction or axis that its reaction presses on; friction is there in joints "
                     "such as revolute, prismatic, cylindrical, point_on_plane");
  if (sliding_.isZero(0) && arm_ == 0 && options_.viscous_turn == 0)
    throw ParameterError({.kind = "force", .name = this->name()}, "radius",
                         "is missing; link '" + link.name() + "' only turns, so say at which radius it rubs");
}

void JointFriction::check_numbers() const {
  const auto must = [&](bool ok, const char* key, double value, const char* limit) {
    if (!ok || !std::isfinite(value))
      throw ParameterError({.kind = "force", .name = name()}, key,
                           "is " + number(value) + "; must be a finite number, " + limit);
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

const TypeInfo& JointFriction::info() {
  static const TypeInfo info{
      "joint_friction",
      "dry and viscous friction in a link, from its present reaction",
      {{"mu", Form::number, Unit::none, kRequired, "coefficient of sliding friction"},
       {"mu_static", Form::number, Unit::none, kOptional, "coefficient at rest (Stribeck); default: mu"},
       {"stribeck_speed", Form::number, Unit::speed, 0.01, "speed over which the coefficient falls to mu"},
       {"smoothing_speed", Form::number, Unit::speed, 0.001, "speed at which the friction has tanh(1) of its size"},
       {"radius", Form::number, Unit::length, 0, "where a joint that turns rubs under its radial load"},
       {"axial_radius", Form::number, Unit::length, 0, "where a joint that turns rubs under its axial load"},
       {"bending_length", Form::number, Unit::length, kOptional,
        "a bending moment M on a joint that slides presses with M/length; half the guide for a couple at its ends"},
       {"preload", Form::number, Unit::force, 0, "normal (radial) force that is always there"},
       {"viscous", Form::number, Unit::damping, 0, "viscous friction of the sliding"},
       {"viscous_turn", Form::number, Unit::torsion_damping, 0, "viscous friction of the turning"},
       {"load_smoothing", Form::number, Unit::force, 1e-6, "size e of a load below which it counts smoothly"}}};
  return info;
}

JointFriction::Options JointFriction::options(const Params& k) {
  Options o;
  o.mu = k.number("mu");
  if (k.has("mu_static")) {
    o.mu_static = k.number("mu_static");
    if (o.mu_static < 0) k.refuse("mu_static", "is " + number(o.mu_static) + "; must be mu or more");
  }
  o.stribeck_speed = k.number("stribeck_speed"), o.smoothing_speed = k.number("smoothing_speed");
  o.radius = k.number("radius"), o.axial_radius = k.number("axial_radius");
  if (k.has("bending_length")) o.bending_length = k.number("bending_length");
  o.preload = k.number("preload"), o.viscous = k.number("viscous"), o.viscous_turn = k.number("viscous_turn");
  o.load_smoothing = k.number("load_smoothing");
  return o;
}

std::unique_ptr<Force> JointFriction::make(const Site& site, const Params& k) {
  return std::make_unique<JointFriction>(site.name, site.carrier(), options(k));
}

void JointFriction::setup() {
  for (const Marker* m : {p_, s_})
    if (m->slide || m->spin)
      throw ModelError("force '" + name() + "': marker '" + m->name + "' of link '" + link_->name() +
                       "' moves on its body by a law, and friction is not there for that; drive the link instead");
  if (link_->jointed()->turned())
    throw ModelError("force '" + name() + "': link '" + link_->name() +
                     "' has a law \"turn\", which turns its free axis away from z of S, and friction is not there for "
                     "that; turn the marker instead, or drive the link");
  P_ = MarkerFrame(*p_), S_ = MarkerFrame(*s_);
}

double JointFriction::size(double square) const {
  const double e = options_.load_smoothing;
  return std::sqrt(square + e * e) - e;
}

// mu(s) = (mu_k + d exp(-(s/v_s)^2)) tanh(s/v_0) as mu/s and (mu/s)'/s, whose limits at rest are the first terms of
// their series.
JointFriction::Slope JointFriction::coefficient(double s) const {
  const double v0 = options_.smoothing_speed, vs = options_.stribeck_speed;
  const double d = options_.mu_static >= 0 ? options_.mu_static - options_.mu : 0.0;
  if (s < 1e-4 * v0) {
    const double at_rest = options_.mu + d;
    return {at_rest / v0, -2.0 * (at_rest / (3 * v0 * v0) + d / (vs * vs)) / v0};
  }
  const double bell = d * std::exp(-(s / vs) * (s / vs)), th = std::tanh(s / v0);
  const double mu = (options_.mu + bell) * th;
  const double slope = -2.0 * s / (vs * vs) * bell * th + (options_.mu + bell) * (1 - th * th) / v0;
  return {mu / s, (slope - mu / s) / (s * s)};
}

JointFriction::Rubbing JointFriction::rubbing(const Inputs& in, const Reactions& reactions) const {
  const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
  Rubbing r;
  r.A = S.A, r.point = P.x;
  r.u = sliding_.cwiseProduct(S.A.transpose() * (P.v - point_velocity(in, S_.slot, P.x)));
  r.in_force = reactions.in_force(*link_);
  if (turning_ >= 0) r.rate = S.A.col(turning_).dot(P.w - S.w);
  if (!r.in_force) return r;
  const LinkWrench load = reactions.on_body_of(P_, *link_, in);
  const Vec3 F = S.A.transpose() * load.force, M = S.A.transpose() * load.moment;
  const Options& o = options_;
  if (!sliding_.isZero(0)) {
    r.normal = o.preload + size(pressing_.cwiseProduct(F).squaredNorm());
    if (o.bending_length > 0) r.normal += size(bending_.cwiseProduct(M).squaredNorm()) / o.bending_length;
    r.force = -(r.normal * coefficient(r.u.norm()).over_speed + o.viscous) * r.u;
  }
  if (turning_ >= 0) {
    r.radial = o.preload + size(radial_.cwiseProduct(F).squaredNorm());
    r.axial = size(axial_.cwiseProduct(F).squaredNorm());
    const double grip = o.radius * r.radial + o.axial_radius * r.axial;
    r.torque = -(grip * arm_ * coefficient(arm_ * std::abs(r.rate)).over_speed + o.viscous_turn) * r.rate;
  }
  return r;
}

void JointFriction::react(const Inputs& in, const Reactions& reactions, WrenchSum& out) const {
  const Rubbing r = rubbing(in, reactions);
  if (!r.in_force) return;
  const Vec3 F = r.A * r.force;
  out.force(P_.slot, F, r.point);
  out.force(S_.slot, -F, r.point);
  if (turning_ < 0) return;
  const Vec3 M = r.torque * r.A.col(turning_);
  out.torque(P_.slot, M);
  out.torque(S_.slot, -M);
}

// N and the bearing's loads are numbers here: the rows hold in S axes, so a reaction with fixed multipliers turns with
// S.
void JointFriction::react_tangent(const Inputs& in, const Reactions& reactions, TangentSum& out) const {
  const Rubbing r = rubbing(in, reactions);
  if (!r.in_force) return;
  const Variation at(in, P_, S_);
  if (!sliding_.isZero(0)) {
    const VaryingVector x = at.point(0);
    const VaryingVector v = at.velocity(0) - (at.velocity(1) + cross(at.turn_rate(1), x - at.point(1)));
    const VaryingVector u = scaled(sliding_, at.in_marker(1, v));
    const Slope mu = coefficient(u.v.norm());
    VaryingVector F = -(r.normal * mu.over_speed + options_.viscous) * u;
    F.d -= r.normal * mu.bend * u.v * (u.v.transpose() * u.d);
    const VaryingVector world = at.in_world(1, F);
    at.force(0, world, x, out);
    at.force(1, -world, x, out);
  }
  if (turning_ < 0) return;
  const VaryingVector axis = at.axis(1, turning_);
  const VaryingNumber w = dot(axis, at.turn_rate(0) - at.turn_rate(1));
  const Slope mu = coefficient(arm_ * std::abs(w.v));
  const double grip = arm_ * (options_.radius * r.radial + options_.axial_radius * r.axial);
  VaryingNumber T = -(grip * mu.over_speed + options_.viscous_turn) * w;
  T.d -= grip * mu.bend * arm_ * arm_ * w.v * w.v * w.d;
  at.torque(0, T * axis, out);
  at.torque(1, -(T * axis), out);
}

double JointFriction::friction_loss(const Inputs& in, const Reactions& reactions) const {
  const Rubbing r = rubbing(in, reactions);
  return r.in_force ? -(r.force.dot(r.u) + r.torque * r.rate) : 0.0;
}

std::vector<Quantity> JointFriction::quantities() const {
  std::vector<Quantity> all;
  if (!sliding_.isZero(0)) all = {{"normal_force", "N"}, {"friction_force", "N"}, {"sliding_speed", "m/s"}};
  if (turning_ >= 0)
    for (const Quantity& q : {Quantity{"radial_force", "N"}, Quantity{"axial_force", "N"},
                              Quantity{"friction_torque", "N m"}, Quantity{"turning_rate", "rad/s"}})
      all.push_back(q);
  return all;
}

double JointFriction::reacting_quantity(int k, const Inputs& in, const Reactions& reactions) const {
  const Rubbing r = rubbing(in, reactions);
  const bool one = sliding_.sum() == 1;
  if (sliding_.isZero(0)) k += 3;
  switch (k) {
    case 0:
      return r.normal;
    case 1:
      return one ? r.force.sum() : r.force.norm();
    case 2:
      return one ? r.u.sum() : r.u.norm();
    case 3:
      return r.radial;
    case 4:
      return r.axial;
    case 5:
      return r.torque;
    default:
      return r.rate;
  }
}

}  // namespace lockstep
