#include "framework/mechanism/forces/spring_damper.h"

#include "framework/mechanism/forces/variation.h"
#include "framework/foundation/support/text.h"

namespace lockstep {

SpringDamper::SpringDamper(std::string name, Marker& p, Marker& s, Options options)
    : MarkerForce(std::move(name), p, &s), options_(std::move(options)) {
  require_finite("stiffness", options_.stiffness);
  require_not_negative("damping", options_.damping);
  require_not_negative("free_length", options_.free_length);
  require_finite("preload", options_.preload);
  add_law(options_.force);
}

const TypeInfo& SpringDamper::info() {
  static const TypeInfo info{
      "spring_damper",
      "spring, damper and linear actuator on the line between the origins of P and S",
      {{"stiffness", Form::number, Unit::stiffness, 0, "force per length"},
       {"damping", Form::number, Unit::damping, 0, "force per speed of lengthening, not negative"},
       {"free_length", Form::number, Unit::length, 0, "length at which the spring pulls with the preload only"},
       {"preload", Form::number, Unit::force, 0, "force at the free length, positive pulls P and S together"},
       {"force", Form::law, Unit::force, kOptional, "law added to the force, positive pulls P and S together"}}};
  return info;
}

std::unique_ptr<Force> SpringDamper::make(const Site& site, const Params& k) {
  Options o{k.number("stiffness"), k.number("damping"), k.number("free_length"), k.number("preload"), {}};
  if (k.has("force")) o.force = k.law("force");
  return std::make_unique<SpringDamper>(site.name, p_of(site, k), s_of(site, k), std::move(o));
}

void SpringDamper::setup() {
  MarkerForce::setup();
  if (p().slide || s()->slide) return;  // they may part before the start
  const double length = ((p().body->home * p().local).x - (s()->body->home * s()->local).x).norm();
  const double T = options_.preload - options_.stiffness * options_.free_length;
  if (length > 1e-9 || (T == 0 && !options_.force)) return;
  throw ModelError("force '" + name() + "': markers '" + p().name + "' and '" + s()->name +
                   "' coincide at the start, so that its force (" + brief(T) + " N at length 0" +
                   (options_.force ? ", and a law" : "") +
                   ") has no direction; move one of them, or make the free length and the preload 0");
}

// The line from S to P at one instant.
struct SpringDamper::Line {
  Vec3 xP, xS, n;
  double length, rate, force;
};

SpringDamper::Line SpringDamper::line(const Inputs& in) const {
  const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
  Line r{P.x, S.x, P.x - S.x, 0, 0, 0};
  r.length = r.n.norm();
  if (r.length == 0) return r;  // n = 0: no direction, no force
  r.n /= r.length;
  r.rate = r.n.dot(P.v - S.v);
  r.force = options_.stiffness * (r.length - options_.free_length) + options_.preload + options_.damping * r.rate +
            value(options_.force, in.t);
  return r;
}

void SpringDamper::apply(const Inputs& in, WrenchSum& out) const {
  const Line r = line(in);
  out.force(P_.slot, -r.force * r.n, r.xP);
  out.force(S_.slot, r.force * r.n, r.xS);
}

void SpringDamper::tangent(const Inputs& in, TangentSum& out) const {
  const Variation at(in, P_, S_);
  const VaryingVector xP = at.point(0), xS = at.point(1), d = xP - xS;
  const double law = value(options_.force, in.t);
  const double at_zero = options_.preload - options_.stiffness * options_.free_length + law;  // tension at length 0
  VaryingVector pull = options_.stiffness * d;  // T n, where it passes zero smoothly
  if (!d.v.isZero(0)) {
    const VaryingNumber l = norm(d);
    const VaryingVector n = inverse(l) * d;
    const VaryingNumber rate = dot(n, at.velocity(0) - at.velocity(1));
    pull = (options_.stiffness * l + options_.damping * rate + at_zero) * n;
  } else if (at_zero != 0) {
    return;  // no direction, no force
  }
  at.force(0, -pull, xP, out);
  at.force(1, pull, xS, out);
}

double SpringDamper::potential(const Inputs& in) const {
  const double x = line(in).length - options_.free_length;
  return 0.5 * options_.stiffness * x * x + options_.preload * x;
}

double SpringDamper::dissipation(const Inputs& in) const {
  const double rate = line(in).rate;
  return options_.damping * rate * rate;
}

std::vector<Quantity> SpringDamper::quantities() const {
  return {{"length", "m"}, {"rate", "m/s"}, {"force", "N"}, {"power", "W"}};
}

double SpringDamper::quantity(int k, const Inputs& in) const {
  const Line r = line(in);
  if (k == 0) return r.length;
  if (k == 1) return r.rate;
  if (k == 2) return r.force;
  return r.force * r.n.dot(point_velocity(in, S_.slot, r.xS) - point_velocity(in, P_.slot, r.xP));
}

// power + dV/dt + D: the law's share, and that of markers which move on their bodies.
double SpringDamper::supply(const Inputs& in) const {
  const Line r = line(in);
  const double stored = options_.stiffness * (r.length - options_.free_length) + options_.preload;
  return quantity(3, in) + (stored + options_.damping * r.rate) * r.rate;
}

}  // namespace lockstep
