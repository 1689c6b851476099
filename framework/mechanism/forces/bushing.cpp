// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>

#include <cmath>

#include <lockstep/author/params.h>
#include "framework/mechanism/forces/effort.h"

namespace lockstep {

Bushing::Bushing(std::string name, Marker& p, Marker& s, Options options)
    : FormulaForce(std::move(name), p, &s), options_(std::move(options)) {
  require_finite("stiffness", options_.stiffness);
  require_finite("torsion_stiffness", options_.torsion_stiffness);
  for (int k = 0; k < 3; ++k) {
    require_not_negative("damping", options_.damping[k]);
    require_not_negative("torsion_damping", options_.torsion_damping[k]);
  }
}

TypeInfo Bushing::info() {
  return {"bushing",
          "springs and dampers along and about the axes of S, for small rotations: a compliant joint",
          {{"stiffness", Form::vector3, Unit::stiffness, Value::List{0, 0, 0}, "along the axes of S"},
           {"damping", Form::vector3, Unit::damping, Value::List{0, 0, 0}, "along the axes of S, not negative"},
           {"torsion_stiffness", Form::vector3, Unit::torsion_stiffness, Value::List{0, 0, 0}, "about the axes of S"},
           {"torsion_damping", Form::vector3, Unit::torsion_damping, Value::List{0, 0, 0},
            "about the axes of S, not negative"}}};
}

std::unique_ptr<Force> Bushing::make(const Attachment& attachment, const Params& k) {
  const Options o{k.vector3("stiffness"), k.vector3("damping"), k.vector3("torsion_stiffness"),
                  k.vector3("torsion_damping")};
  return std::make_unique<Bushing>(attachment.name, p_of(attachment, k), s_of(attachment, k), o);
}

void Bushing::setup() {
  require_turning(*s(), "has a lever arm on");
  if (!options_.torsion_stiffness.isZero(0) || !options_.torsion_damping.isZero(0)) require_turning(p(), "rotates");
  MarkerForce::setup();
}

// Each matrix takes the normal to a multiple of it, and P turns about it.
bool Bushing::stays_in_plane(Plane plane) const {
  const Vec3 P = P_.A0.row(plane.n), S = S_.A0.row(plane.n);
  const auto fits = [&](const Vec3& diagonal) { return are_parallel(diagonal.normalized().cwiseProduct(S), S); };
  return markers_stay_in(plane) && fits(options_.stiffness) && fits(options_.damping) &&
         fits(options_.torsion_damping) && fits(options_.torsion_stiffness) &&
         (options_.torsion_stiffness.isZero(0) || (P - S).norm() <= kParallel);
}

std::vector<Quantity> Bushing::quantities() const {
  std::vector<Quantity> r;
  for (const auto& [stem, unit, help] : {Quantity{"", "m", "position of P relative to S, S axes, "},
                                         Quantity{"angle_", "rad", "rotation vector of P relative to S, S axes, "},
                                         Quantity{"force_on_p_link_", "N", "force on P's body, S axes, "},
                                         Quantity{"torque_on_p_link_", "N m", "torque on P's body, S axes, "}})
    for (const char* axis : {"x", "y", "z"}) r.push_back({stem + axis, unit, help + axis});
  r.push_back(power());
  return r;
}

namespace {
// c of J = 1 - 1/2 th~ + c th~^2; c = 1/12 + a^2/720 + a^4/30240 + ... near a = 0
template <class T>
T second_factor(const T& a2) {
  using std::sqrt, std::tan;
  if (a2 < 1e-2) return 1.0 / 12 + a2 * (1.0 / 720 + a2 * (1.0 / 30240 + a2 * (1.0 / 1209600)));
  const T half = 0.5 * sqrt(a2);
  return (1.0 - half / tan(half)) / a2;
}
}  // namespace

template <class T, class Load>
void Bushing::act(const Ends<T>& at, Load& load) const {
  using V = Vec3T<T>;
  const auto& [K, C, Kt, Ct] = options_;
  const Mat3T<T> A = at.S.A();
  const auto in_S = [&A](const V& b) -> V { return A.transpose() * b; };
  const V x = at.P.x(), w_S = at.S.w(), d = in_S(x - at.S.x());
  const V dd = in_S(at.P.v() - at.S.v()) - cross(in_S(w_S), d), w = in_S(at.P.w() - w_S);
  const V th = rotation_vector(conjugate(at.S.q()) * at.P.q());

  const V Kd = K.cwiseProduct(d), Cdd = C.cwiseProduct(dd), b = Kt.cwiseProduct(th), Cw = Ct.cwiseProduct(w);
  const V thb = cross(th, b), Jb = b + 0.5 * thb + second_factor(T(th.dot(th))) * cross(th, thb);  // J' Kt th
  const V F = -Kd - Cdd, M = -Jb - Cw;
  load.force(A * F, x);
  load.torque(A * M);
  load.stores(0.5 * (d.dot(Kd) + th.dot(b)));
  load.dissipates(dd.dot(Cdd) + w.dot(Cw));
  load.shows(d, th, F, M);
}

template class FormulaForce<Bushing>;

}  // namespace lockstep
