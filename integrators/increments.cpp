// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <algorithm>
#include <cmath>

namespace lockstep {

namespace {

// (1 - (a/2) cot(a/2))/a^2; the series' next term is a^6/1209600.
double curvature(double a2) {
  if (a2 < 1e-2) return 1.0 / 12 + a2 / 720 + a2 * a2 / 30240;
  const double half = 0.5 * std::sqrt(a2);
  return (1 - half / std::tan(half)) / a2;
}

Quat quat_of(const VecX& q, Eigen::Index slot) { return Quat::from(q.segment<4>(7 * slot + 3)); }

}  // namespace

void displace_state(const State& start, Eigen::Ref<const VecX> y, State& out) {
  const Eigen::Index n = start.v.size();
  for (Eigen::Index k = 0; 6 * k < n; ++k) {
    out.q.segment<3>(7 * k) = start.q.segment<3>(7 * k) + y.segment<3>(6 * k);
    out.q.segment<4>(7 * k + 3) = (quat_of(start.q, k) * exponential(Vec3(y.segment<3>(6 * k + 3)))).coefficients();
  }
  out.v = start.v + y.segment(n, n);
  out.s = start.s + y.tail(start.s.size());
}

void increment_rates(Eigen::Ref<const VecX> y, const State& here, const StateRate& k, Eigen::Ref<VecX> out) {
  const Eigen::Index n = here.v.size();
  for (Eigen::Index i = 0; i < n; i += 6) {
    out.segment<3>(i) = here.v.segment<3>(i);
    const Vec3 D = y.segment<3>(i + 3), w = here.v.segment<3>(i + 3), Dw = cross(D, w);
    out.segment<3>(i + 3) = w + 0.5 * Dw + curvature(D.squaredNorm()) * cross(D, Dw);
  }
  out.segment(n, n) = k.v;
  out.tail(here.s.size()) = k.s;
}

void as_difference(Eigen::Ref<const VecX> y, const State& at, StateRate& out) {
  const Eigen::Index n = at.v.size();
  for (Eigen::Index k = 0; 6 * k < n; ++k) {
    out.q.segment<3>(7 * k) = y.segment<3>(6 * k);
    out.q.segment<4>(7 * k + 3) = rate(quat_of(at.q, k), Vec3(y.segment<3>(6 * k + 3))).coefficients();
  }
  out.v = y.segment(n, n);
  out.s = y.tail(at.s.size());
}

void count_from(Eigen::Ref<const VecX> y1, Eigen::Index n_velocities, Eigen::Ref<VecX> y) {
  for (Eigen::Index i = 0; i < n_velocities; i += 6) {
    const Quat turn = exponential(Vec3(-y1.segment<3>(i + 3))) * exponential(Vec3(y.segment<3>(i + 3)));
    y.segment<3>(i) -= y1.segment<3>(i);
    y.segment<3>(i + 3) = rotation_vector(turn);
  }
  y.tail(y.size() - n_velocities) -= y1.tail(y.size() - n_velocities);
}

double largest_turn(Eigen::Ref<const VecX> y, Eigen::Index n_velocities) {
  double most = 0;
  for (Eigen::Index i = 3; i < n_velocities; i += 6) most = std::max(most, y.segment<3>(i).squaredNorm());
  return std::sqrt(most);
}

}  // namespace lockstep
