#include "framework/mechanism/forces/force_motor.h"

#include "framework/mechanism/forces/variation.h"

namespace lockstep {

ForceMotor::ForceMotor(std::string name, Marker& p, Marker& s, Options options)
    : MarkerForce(std::move(name), p, &s), options_(std::move(options)) {
  require(options_.force != nullptr, "force", "is missing; give a law");
  add_law(options_.force);
}

const TypeInfo& ForceMotor::info() {
  static const TypeInfo info{"force_motor",
                             "force by a law along z of S on P's body at P, the opposite on S's body at the same point",
                             {{"force", Form::law, Unit::force, kRequired, "law of the force on p's body along z of s"}}};
  return info;
}

std::unique_ptr<Force> ForceMotor::make(const Site& site, const Params& k) {
  return std::make_unique<ForceMotor>(site.name, p_of(site, k), s_of(site, k), Options{k.law("force")});
}

void ForceMotor::setup() {
  require_turning(*s(), "puts a force with a lever arm on");
  MarkerForce::setup();
}

void ForceMotor::apply(const Inputs& in, WrenchSum& out) const {
  const Vec3 F = value(options_.force, in.t) * in_world(S_, in).A.col(2), x = in_world(P_, in).x;
  out.force(P_.slot, F, x);
  out.force(S_.slot, -F, x);
}

void ForceMotor::tangent(const Inputs& in, TangentSum& out) const {
  const Variation at(in, P_, S_);
  const VaryingVector F = value(options_.force, in.t) * at.axis(1, 2), x = at.point(0);
  at.force(0, F, x, out);
  at.force(1, -F, x, out);
}

std::vector<Quantity> ForceMotor::quantities() const { return {{"force", "N"}, {"rate", "m/s"}, {"power", "W"}}; }

double ForceMotor::quantity(int k, const Inputs& in) const {
  const double F = value(options_.force, in.t);
  if (k == 0) return F;
  const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
  const Vec3 z = S.A.col(2);
  if (k == 1) return z.dot(P.v - S.v - cross(S.w, Vec3(P.x - S.x)));
  return F * z.dot(point_velocity(in, P_.slot, P.x) - point_velocity(in, S_.slot, P.x));
}

double ForceMotor::supply(const Inputs& in) const { return quantity(2, in); }

}  // namespace lockstep
