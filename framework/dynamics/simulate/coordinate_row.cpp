#include "framework/dynamics/simulate/coordinate_row.h"

#include <cmath>
#include <string>

#include <lockstep/error.h>
#include <lockstep/relative.h>

namespace lockstep {

namespace {

double value_of(const Inputs& in, const MarkerFrame& P, const MarkerFrame& S, Axis axis) {
  const int k = axis_index(axis) % 3;
  const MarkerInWorld p = in_world(P, in), s = in_world(S, in);
  if (!is_rotation(axis)) return s.A.col(k).dot(Vec3(p.x - s.x));
  const Mat3 A = s.A.transpose() * p.A;  // axes of P in those of S
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  return std::atan2(A(j, i) - A(i, j), A(i, i) + A(j, j));
}

}  // namespace

double coordinate_value(Dynamics& dynamics, const State& state, const Lock& link, Axis axis) {
  const auto [p, s] = link.pairs().front();
  return value_of(dynamics.inputs(state), MarkerFrame(*p), MarkerFrame(*s), axis);
}

CoordinateRow coordinate_row(Dynamics& dynamics, const State& state, const std::string& name, Axis which) {
  const Lock& link = dynamics.system().link(name);
  const auto pairs = link.pairs();
  if (pairs.empty())
    throw ModelError("link '" + name + "' has no pair of markers, and so no coordinate " +
                     std::string(to_string(which)) + " to start from; name a link between two bodies");
  const auto [p, s] = pairs.front();
  const MarkerFrame P(*p), S(*s);
  const Inputs& in = dynamics.inputs(state);
  const auto O1 = kernel::body(in.slot(P.slot)), O2 = kernel::body(in.slot(S.slot));
  const auto mP = kernel::marker<true, true>(P.at(in.t)), mS = kernel::marker<true, true>(S.at(in.t));
  const int k = axis_index(which) % 3;
  const auto axis = vec::vector(Vec3(Vec3::Unit(k)));
  const auto n2 = mS.A * axis, n = O2.A * n2;
  CoordinateRow out;
  out.row = VecX::Zero(6 * dynamics.system().n_slots());
  const auto put = [&](int slot, double sign, const auto& v, const auto& w) {
    if (slot == kGround) return;
    out.row.segment<3>(6 * slot) += sign * vec::as<Vec3>(v);
    out.row.segment<3>(6 * slot + 3) += vec::as<Vec3>(w);
  };
  const auto put_both = [&](const auto& r) { put(P.slot, 1, r.v, r.w1), put(S.slot, -1, r.v, r.w2); };
  if (is_rotation(which)) {
    put_both(kernel::angular_velocity_row(O1.A, n, n2));
    out.rate = dot(axis, kernel::relative_angular_velocity(O1, O2, mP, mS));
  } else {
    const auto at = kernel::position(O1, O2, mP, mS);
    put_both(kernel::translation_row(O1.A, mP.u, at.s, n, n2));
    out.rate = dot(axis, kernel::position_rate(mS, at, kernel::velocity(O1, O2, mP, at)));
  }
  out.value = value_of(in, P, S, which);
  return out;
}

}  // namespace lockstep
