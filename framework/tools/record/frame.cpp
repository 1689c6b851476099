// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/frame.h"

namespace lockstep::channels {

MarkerOn<double> Frame::at(const Sample& sample) const {
  if (const long now = sample.system().revision(); revision != now) last = folded(), revision = now;
  return marker_on(last, sample.inputs());
}

namespace {

template <int n, int m>
Eigen::Matrix<Time, n, m> with_rates(const Eigen::Matrix<double, n, m>& x, const Eigen::Matrix<double, n, m>& rates) {
  return x.binaryExpr(rates, [](double value, double rate) { return Time(value, rate, 0.0); });
}

}  // namespace

// a_m = a + A (al x u + w x (w x u + 2 ud) + udd),  al_m = B' al - pi x B' w + pid: pi turns the marker's axes B on the slot
MotionT<Time> Frame::moving(const Sample& sample) const {
  const VecX& acc = sample.accelerations();
  const MarkerOn<double> on = at(sample);
  const Motion& O = on.slot;
  const MarkerMotion& m = on.marker;
  Vec3 a = Vec3::Zero(), al = Vec3::Zero();
  if (last.slot != kGround) a = acc.segment<3>(6 * last.slot), al = acc.segment<3>(6 * last.slot + 3);
  const Vec3 carried = m.A.transpose() * O.w, w = carried + m.w;
  const Mat3 A = on.A();
  const Quat q = on.q();
  const Vec3 a_m = a + O.A * (cross(al, m.u) + cross(O.w, Vec3(cross(O.w, m.u) + 2.0 * m.ud)) + m.udd);
  const Vec3 al_m = m.A.transpose() * al - cross(m.w, carried) + m.a;
  return {.x = with_rates<3, 1>(on.x(), on.v()),
          .A = with_rates<3, 3>(A, A * skew(w)),
          .e = QuatT<Time>::from(with_rates<4, 1>(q.coefficients(), rate(q, w).coefficients())),
          .v = with_rates<3, 1>(on.v(), a_m),
          .w = with_rates<3, 1>(w, al_m)};
}

}  // namespace lockstep::channels
