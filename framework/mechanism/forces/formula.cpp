// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/formula.h>

namespace lockstep::formula {

// x <- x + dx, q <- q exp(dth/2): dA = A dth~, de = (1/2) e dth
MotionT<SlotJet> varied(const Motion& O, Vary what) {
  MotionT<SlotJet> r{
      O.x.cast<SlotJet>(), O.A.cast<SlotJet>(), {O.e.w, O.e.x, O.e.y, O.e.z}, O.v.cast<SlotJet>(), O.w.cast<SlotJet>()};
  if (what == Vary::nothing) return r;
  for (int k = 0; k < 3; ++k) {
    if (what == Vary::velocity) {
      r.v[k].g[k] = r.w[k].g[3 + k] = 1;
      continue;
    }
    r.x[k].g[k] = 1;
    const Mat3 dA = O.A * skew(Vec3::Unit(k));
    for (int i = 0; i < 9; ++i) r.A(i).g[3 + k] = dA(i);
    const Quat de = rate(O.e, Vec3(Vec3::Unit(k)));
    r.e.w.g[3 + k] = de.w, r.e.x.g[3 + k] = de.x, r.e.y.g[3 + k] = de.y, r.e.z.g[3 + k] = de.z;
  }
  return r;
}

TangentLoad::TangentLoad(const Ends<SlotJet>& ends) : at(ends) {
  for (int i = 0; i < 2; ++i) F[i].setZero(), M[i].setZero();
}

void TangentLoad::force(const Vec& f, const Vec& x_P, const Vec& x_S) {
  F[0] += f, F[1] -= f;
  M[0] += at.P.slot.A.transpose() * cross(Vec(x_P - at.P.slot.x), f);
  M[1] -= at.S.slot.A.transpose() * cross(Vec(x_S - at.S.slot.x), f);
}

void TangentLoad::torque(const Vec& m) {
  M[0] += at.P.slot.A.transpose() * m;
  M[1] -= at.S.slot.A.transpose() * m;
}

Mat6 TangentLoad::rows(int i) const {
  Mat6 d;
  for (int k = 0; k < 3; ++k) d.row(k) = -F[i][k].g.transpose(), d.row(3 + k) = -M[i][k].g.transpose();
  return d;
}

}  // namespace lockstep::formula
