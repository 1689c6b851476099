#include "framework/mechanism/forces/torsion_spring_damper.h"

#include <cmath>

#include "framework/mechanism/forces/variation.h"

namespace lockstep {

TorsionSpringDamper::TorsionSpringDamper(std::string name, Marker& p, Marker& s, Options options)
    : MarkerForce(std::move(name), p, &s), options_(std::move(options)) {
  require_finite("stiffness", options_.stiffness);
  require_not_negative("damping", options_.damping);
  require_finite("free_angle", options_.free_angle);
  require_finite("preload", options_.preload);
  add_law(options_.torque);
}

const TypeInfo& TorsionSpringDamper::info() {
  static const TypeInfo info{
      "torsion_spring_damper",
      "spring, damper and rotary actuator about the common z axis of P and S, turns counted",
      {{"stiffness", Form::number, Unit::torsion_stiffness, 0, "torque per angle"},
       {"damping", Form::number, Unit::torsion_damping, 0, "torque per angular speed, not negative"},
       {"free_angle", Form::number, Unit::angle, 0, "angle of P against S at which only the preload acts"},
       {"preload", Form::number, Unit::torque, 0, "torque at the free angle, positive turns P back about z of S"},
       {"torque", Form::law, Unit::torque, kOptional, "law added to the torque, positive turns P back about z of S"}}};
  return info;
}

std::unique_ptr<Force> TorsionSpringDamper::make(const Site& site, const Params& k) {
  Options o{k.number("stiffness"), k.number("damping"), k.number("free_angle"), k.number("preload"), {}};
  if (k.has("torque")) o.torque = k.law("torque");
  return std::make_unique<TorsionSpringDamper>(site.name, p_of(site, k), s_of(site, k), std::move(o));
}

void TorsionSpringDamper::setup() {
  require_turning(p(), "turns");
  require_turning(*s(), "turns");
  MarkerForce::setup();
  const Vec3 zP = rotation((p().body->home * p().local).q).col(2),
             zS = rotation((s()->body->home * s()->local).q).col(2);
  if (p().spin || s()->spin || 1 + zP.dot(zS) > 1e-9) return;
  throw ModelError("force '" + name() + "': the z axes of markers '" + p().name + "' and '" + s()->name +
                   "' point against one another at the start, so that there is no angle about them; turn one marker by "
                   "half a turn about its x axis");
}

// P against S about the axis at one instant.
struct TorsionSpringDamper::Turn {
  Vec3 g;  // gradient of the angle, world axes
  double angle, rate, torque;
};

TorsionSpringDamper::Turn TorsionSpringDamper::turn(const Inputs& in) const {
  const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
  const Quat e = conjugate(in.slot(S_.slot).e * S_.at(in.t).q) * (in.slot(P_.slot).e * P_.at(in.t).q);
  const double last = in.z[static_cast<std::size_t>(first_memory())];
  Turn r;
  r.angle = 2 * std::atan2(e.z, e.w);
  r.angle += kTwoPi * std::round((last - r.angle) / kTwoPi);

  const Vec3 zP = P.A.col(2), zS = S.A.col(2);
  const double c = 1 + zP.dot(zS);
  r.g = Vec3::Zero(), r.rate = r.torque = 0;
  if (c == 0) return r;  // no angle, no torque
  r.g = (zP + zS) / c;
  r.rate = r.g.dot(P.w - S.w);
  r.torque = options_.stiffness * (r.angle - options_.free_angle) + options_.preload + options_.damping * r.rate +
             value(options_.torque, in.t);
  return r;
}

void TorsionSpringDamper::accept(const Inputs& in, std::span<double> z) const { z[0] = turn(in).angle; }

void TorsionSpringDamper::apply(const Inputs& in, WrenchSum& out) const {
  const Turn r = turn(in);
  out.torque(P_.slot, -r.torque * r.g);
  out.torque(S_.slot, r.torque * r.g);
}

void TorsionSpringDamper::tangent(const Inputs& in, TangentSum& out) const {
  const Turn r = turn(in);
  const Variation at(in, P_, S_);
  const VaryingVector zP = at.axis(0, 2), zS = at.axis(1, 2);
  const VaryingNumber c = dot(zP, zS) + 1.0;
  if (c.v == 0) return;  // no angle, no torque
  const VaryingVector g = inverse(c) * (zP + zS);
  VaryingNumber angle = dot(g, at.relative_turn());
  angle.v = r.angle;
  const VaryingNumber rate = dot(g, at.turn_rate(0) - at.turn_rate(1));
  const double rest = options_.preload - options_.stiffness * options_.free_angle + value(options_.torque, in.t);
  const VaryingVector M = (options_.stiffness * angle + options_.damping * rate + rest) * g;
  at.torque(0, -M, out);
  at.torque(1, M, out);
}

double TorsionSpringDamper::potential(const Inputs& in) const {
  const double x = turn(in).angle - options_.free_angle;
  return 0.5 * options_.stiffness * x * x + options_.preload * x;
}

double TorsionSpringDamper::dissipation(const Inputs& in) const {
  const double rate = turn(in).rate;
  return options_.damping * rate * rate;
}

std::vector<Quantity> TorsionSpringDamper::quantities() const {
  return {{"angle", "rad"}, {"rate", "rad/s"}, {"torque", "N m"}, {"power", "W"}};
}

double TorsionSpringDamper::quantity(int k, const Inputs& in) const {
  const Turn r = turn(in);
  if (k == 0) return r.angle;
  if (k == 1) return r.rate;
  if (k == 2) return r.torque;
  return r.torque * r.g.dot(turn_rate(in, S_.slot) - turn_rate(in, P_.slot));
}

// power + dV/dt + D: the law's share, and that of markers which move on their bodies.
double TorsionSpringDamper::supply(const Inputs& in) const {
  const Turn r = turn(in);
  const double stored = options_.stiffness * (r.angle - options_.free_angle) + options_.preload;
  return quantity(3, in) + (stored + options_.damping * r.rate) * r.rate;
}

}  // namespace lockstep
