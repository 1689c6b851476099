#include "framework/mechanism/forces/bushing.h"

#include <cmath>

#include "framework/mechanism/forces/variation.h"

namespace lockstep {

Bushing::Bushing(std::string name, Marker& p, Marker& s, Options options)
    : MarkerForce(std::move(name), p, &s), options_(std::move(options)) {
  require_finite("stiffness", options_.stiffness);
  require_finite("torsion_stiffness", options_.torsion_stiffness);
  for (int k = 0; k < 3; ++k) {
    require_not_negative("damping", options_.damping[k]);
    require_not_negative("torsion_damping", options_.torsion_damping[k]);
  }
}

const TypeInfo& Bushing::info() {
  static const TypeInfo info{
      "bushing",
      "springs and dampers along and about the axes of S, for small turns: a soft joint",
      {{"stiffness", Form::vector3, Unit::stiffness, Value::List{0, 0, 0}, "along the axes of S"},
       {"damping", Form::vector3, Unit::damping, Value::List{0, 0, 0}, "along the axes of S, not negative"},
       {"torsion_stiffness", Form::vector3, Unit::torsion_stiffness, Value::List{0, 0, 0}, "about the axes of S"},
       {"torsion_damping", Form::vector3, Unit::torsion_damping, Value::List{0, 0, 0}, "about the axes of S, not negative"}}};
  return info;
}

std::unique_ptr<Force> Bushing::make(const Site& site, const Params& k) {
  const Options o{k.vector3("stiffness"), k.vector3("damping"), k.vector3("torsion_stiffness"),
                  k.vector3("torsion_damping")};
  return std::make_unique<Bushing>(site.name, p_of(site, k), s_of(site, k), o);
}

void Bushing::setup() {
  require_turning(*s(), "puts a force with a lever arm on");
  if (!options_.torsion_stiffness.isZero(0) || !options_.torsion_damping.isZero(0)) require_turning(p(), "turns");
  MarkerForce::setup();
}

// P against S at one instant, in the axes of S.
struct Bushing::Offset {
  Vec3 x, d, dd, th, w, F, M;
  Mat3 A_S;
};

namespace {
// c of J = 1 - 1/2 th~ + c th~^2; c = 1/12 + a^2/720 + a^4/30240 + ... near a = 0
double second_factor(double a2) {
  const double a = std::sqrt(a2);
  return a2 < 1e-2 ? 1.0 / 12 + a2 / 720 + a2 * a2 / 30240 + a2 * a2 * a2 / 1209600
                   : (1 - 0.5 * a / std::tan(0.5 * a)) / a2;
}
// dc/d(a^2). The series is that of c: |B_2n| (a^2)^(n-1) / (2n)!, B_2n the Bernoulli numbers.
double rate_of_second_factor(double a2) {
  if (a2 < 0.5)
    return 1.0 / 720 +
           a2 * (2.0 / 30240 +
                 a2 * (3.0 / 1209600 +
                       a2 * (4.0 / 47900160 + a2 * (5.0 * 691 / 1307674368000 +
                                                    a2 * (6.0 / 74724249600 + a2 * 7 * 3617 / 10670622842880000)))));
  const double a = std::sqrt(a2), s = std::sin(0.5 * a), f = 0.5 * a / std::tan(0.5 * a);  // c = (1 - f)/a^2
  const double fd = 0.25 / a * (std::cos(0.5 * a) / s - 0.5 * a / (s * s));                // df/d(a^2)
  return -fd / a2 - (1 - f) / (a2 * a2);
}
// J' b
Vec3 transposed_rate(const Vec3& th, const Vec3& b) {
  const Vec3 thb = cross(th, b);
  return b + 0.5 * thb + second_factor(th.squaredNorm()) * cross(th, thb);
}
}  // namespace

Bushing::Offset Bushing::offset(const Inputs& in) const {
  const MarkerInWorld P = in_world(P_, in), S = in_world(S_, in);
  Offset r;
  r.x = P.x, r.A_S = S.A;
  r.d = S.A.transpose() * (P.x - S.x);
  r.dd = S.A.transpose() * (P.v - S.v) - cross(Vec3(S.A.transpose() * S.w), r.d);
  r.th = rotation_vector(conjugate(in.slot(S_.slot).e * S_.at(in.t).q) * (in.slot(P_.slot).e * P_.at(in.t).q));
  r.w = S.A.transpose() * (P.w - S.w);
  r.F = -options_.stiffness.cwiseProduct(r.d) - options_.damping.cwiseProduct(r.dd);
  r.M = -transposed_rate(r.th, options_.torsion_stiffness.cwiseProduct(r.th)) -
        options_.torsion_damping.cwiseProduct(r.w);
  return r;
}

void Bushing::apply(const Inputs& in, WrenchSum& out) const {
  const Offset r = offset(in);
  const Vec3 F = r.A_S * r.F, M = r.A_S * r.M;
  out.force(P_.slot, F, r.x);
  out.force(S_.slot, -F, r.x);
  out.torque(P_.slot, M);
  out.torque(S_.slot, -M);
}

void Bushing::tangent(const Inputs& in, TangentSum& out) const {
  const Offset r = offset(in);
  const Variation at(in, P_, S_);
  const VaryingVector xP = at.point(0), apart = xP - at.point(1), d = at.in_marker(1, apart);
  const VaryingVector dd = at.in_marker(1, at.velocity(0) - at.velocity(1) - cross(at.turn_rate(1), apart));
  const VaryingVector F = at.in_world(1, -(scaled(options_.stiffness, d) + scaled(options_.damping, dd)));

  // th changes by J A_S' times the small turn of P against S
  const double a2 = r.th.squaredNorm();
  const Mat3 T = skew(r.th);
  VaryingVector th{r.th,
                   (Mat3::Identity() - 0.5 * T + second_factor(a2) * T * T) * r.A_S.transpose() * at.relative_turn().d};
  const VaryingNumber c{second_factor(a2), 2.0 * rate_of_second_factor(a2) * r.th.transpose() * th.d};
  const VaryingVector b = scaled(options_.torsion_stiffness, th), thb = cross(th, b);
  const VaryingVector w = at.in_marker(1, at.turn_rate(0) - at.turn_rate(1));
  const VaryingVector M = at.in_world(1, -(b + 0.5 * thb + c * cross(th, thb) + scaled(options_.torsion_damping, w)));
  at.force(0, F, xP, out);
  at.force(1, -F, xP, out);
  at.torque(0, M, out);
  at.torque(1, -M, out);
}

double Bushing::potential(const Inputs& in) const {
  const Offset r = offset(in);
  return 0.5 * r.d.dot(options_.stiffness.cwiseProduct(r.d)) +
         0.5 * r.th.dot(options_.torsion_stiffness.cwiseProduct(r.th));
}

double Bushing::dissipation(const Inputs& in) const {
  const Offset r = offset(in);
  return r.dd.dot(options_.damping.cwiseProduct(r.dd)) + r.w.dot(options_.torsion_damping.cwiseProduct(r.w));
}

std::vector<Quantity> Bushing::quantities() const {
  std::vector<Quantity> r;
  for (const auto& [stem, unit] : {Quantity{"", "m"}, Quantity{"angle_", "rad"}, Quantity{"force_on_p_link_", "N"},
                                   Quantity{"torque_on_p_link_", "N m"}})
    for (const char* axis : {"x", "y", "z"}) r.push_back({stem + axis, unit});
  r.push_back({"power", "W"});
  return r;
}

double Bushing::quantity(int k, const Inputs& in) const {
  const Offset r = offset(in);
  if (k < 3) return r.d[k];
  if (k < 6) return r.th[k - 3];
  if (k < 9) return r.F[k - 6];
  if (k < 12) return r.M[k - 9];
  return (r.A_S * r.F).dot(point_velocity(in, P_.slot, r.x) - point_velocity(in, S_.slot, r.x)) +
         (r.A_S * r.M).dot(turn_rate(in, P_.slot) - turn_rate(in, S_.slot));
}

// power + dV/dt + D: the share of markers that move on their bodies; dV/dt = d'K dd + (J' Kt th)'w.
double Bushing::supply(const Inputs& in) const {
  const Offset r = offset(in);
  const double stored = r.d.dot(options_.stiffness.cwiseProduct(r.dd)) +
                        transposed_rate(r.th, options_.torsion_stiffness.cwiseProduct(r.th)).dot(r.w);
  return quantity(12, in) + stored + dissipation(in);
}

}  // namespace lockstep
