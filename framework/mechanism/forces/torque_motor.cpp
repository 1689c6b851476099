#include "framework/mechanism/forces/torque_motor.h"

#include "framework/mechanism/forces/variation.h"

namespace lockstep {

TorqueMotor::TorqueMotor(std::string name, Marker& p, Marker& s, Options options)
    : MarkerForce(std::move(name), p, &s), options_(std::move(options)) {
  require(options_.torque != nullptr, "torque", "is missing; give a law");
  add_law(options_.torque);
}

const TypeInfo& TorqueMotor::info() {
  static const TypeInfo info{"torque_motor",
                             "torque by a law about z of S on P's body, the opposite on S's body",
                             {{"torque", Form::law, Unit::torque, kRequired, "law of the torque on p's body about z of s"}}};
  return info;
}

std::unique_ptr<Force> TorqueMotor::make(const Site& site, const Params& k) {
  return std::make_unique<TorqueMotor>(site.name, p_of(site, k), s_of(site, k), Options{k.law("torque")});
}

void TorqueMotor::setup() {
  require_turning(p(), "turns");
  require_turning(*s(), "turns");
  MarkerForce::setup();
}

void TorqueMotor::apply(const Inputs& in, WrenchSum& out) const {
  const Vec3 M = value(options_.torque, in.t) * in_world(S_, in).A.col(2);
  out.torque(P_.slot, M);
  out.torque(S_.slot, -M);
}

void TorqueMotor::tangent(const Inputs& in, TangentSum& out) const {
  const Variation at(in, P_, S_);
  const VaryingVector M = value(options_.torque, in.t) * at.axis(1, 2);
  at.torque(0, M, out);
  at.torque(1, -M, out);
}

std::vector<Quantity> TorqueMotor::quantities() const { return {{"torque", "N m"}, {"rate", "rad/s"}, {"power", "W"}}; }

double TorqueMotor::quantity(int k, const Inputs& in) const {
  const double T = value(options_.torque, in.t);
  if (k == 0) return T;
  const MarkerInWorld S = in_world(S_, in);
  const Vec3 z = S.A.col(2);
  if (k == 1) return z.dot(in_world(P_, in).w - S.w);
  return T * z.dot(turn_rate(in, P_.slot) - turn_rate(in, S_.slot));
}

double TorqueMotor::supply(const Inputs& in) const { return quantity(2, in); }

}  // namespace lockstep
