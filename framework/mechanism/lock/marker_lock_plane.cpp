// MarkerLock in a planar mechanism: (3.8)-(3.12) and (4.10)-(4.14) with everything in the plane or along its normal.
#include "framework/mechanism/lock/marker_lock_gather.h"
#include "framework/foundation/support/clones.h"
#include "framework/foundation/support/error.h"
#include "framework/foundation/support/text.h"

namespace lockstep {
namespace {

// The axis of the frame that lies along the plane's normal, -1 if none does.
int axis_along(const Mat3& A, int n) {
  for (int a = 0; a < 3; ++a)
    if (std::abs(std::abs(A(n, a)) - 1.0) < 1e-12) return a;
  return -1;
}

[[noreturn, gnu::noinline, gnu::cold]] void leaves_plane(const MarkerLock& lock, double t) {
  throw ModelError("link '" + lock.name() + "': its law leaves the plane at t = " + number(t) +
                   " s, and the scene is planar; take \"planar\" out");
}

}  // namespace

bool MarkerLock::setup_plane(Plane plane) {
  flat_ = {};
  flat_.plane = plane;
  if (P_.slide || P_.spin || S_.slide || S_.spin || row_count() != n_rows_) return false;
  const int a = axis_along(S_.A0, plane.n);
  if (a < 0) return false;
  Flat& f = flat_;
  f.turn_axis = a;
  f.turn = has(rows_, row_bit(3 + a));
  if (f.turn && axis_along(P_.A0, plane.n) != a) return false;
  for (int k = 0; k < 3; ++k)
    if (k != a && has(rows_, row_bit(k))) f.axes[f.n_translations++] = k;
  f.pair = f.n_translations == 2;
  if (f.n_translations == 0 && !f.turn && (laws_ & (with::p | with::qD)))
    throw ModelError("link '" + name() + "' has laws and no row in the plane of the scene; take \"planar\" out");
  f.uP[0] = P_.u0[plane.i()], f.uP[1] = P_.u0[plane.j()];
  f.uS[0] = S_.u0[plane.i()], f.uS[1] = S_.u0[plane.j()];
  for (int k = 0; k < f.n_translations; ++k)
    f.S[k][0] = S_.A0(plane.i(), f.axes[k]), f.S[k][1] = S_.A0(plane.j(), f.axes[k]);
  f.sign_P = P_.A0(plane.n, a) > 0 ? 1 : -1;
  f.sign_S = S_.A0(plane.n, a) > 0 ? 1 : -1;
  const Quat one = conjugate(S_.q0) * P_.q0;
  const Quat normal = conjugate(S_.q0) * (Quat::from(0.0, Vec3(Vec3::Unit(plane.n))) * P_.q0);
  f.e[0] = one.w, f.e[1] = normal.w, f.e[2] = one.vec()[a], f.e[3] = normal.vec()[a];
  return true;
}

// A law that leaves the plane, now.
void MarkerLockGather::check_laws(const MarkerLock& lock) const {
  if (!(lock.laws_ & (with::p | with::qD))) return;
  const int a = lock.flat_.turn_axis;
  if ((lock.laws_ & with::p) && has(lock.rows_, row_bit(a)) && imposed_translation(lock).p[a] != 0)
    leaves_plane(lock, in.t);
  if (!(lock.laws_ & with::qD)) return;
  Vec3 other = imposed_rotation(lock).q.vec();
  other[a] = 0;
  if (other.squaredNorm() > 1e-24) leaves_plane(lock, in.t);
}

LOCKSTEP_FLAT_CLONES void MarkerLockGather::in_plane(Group links, RowSpan out) const {
  for (std::size_t l = 0; l < links.size(); ++l) {
    const auto& lock = static_cast<const MarkerLock&>(*links[l]);
    const MarkerLock::Flat& f = lock.flat_;
    const Motion &O1 = in.slot(lock.P_.slot), &O2 = in.slot(lock.S_.slot);
    const int i = f.plane.i(), j = f.plane.j(), n = f.plane.n;
    const RowBlock block = out.lane(l);
    const double w1 = O1.w[n], w2 = O2.w[n];
    check_laws(lock);
    int row = 0;
    if (f.n_translations > 0) {
      // (3.8) r = A1 uP,  d = A2 s = x1 + r - x2,  C = A_S^T (s - uS) - p
      const double c1 = O1.A(i, i), s1 = O1.A(j, i), c2 = O2.A(i, i), s2 = O2.A(j, i);
      const double rx = c1 * f.uP[0] - s1 * f.uP[1], ry = s1 * f.uP[0] + c1 * f.uP[1];
      const double dx = O1.x[i] + rx - O2.x[i], dy = O1.x[j] + ry - O2.x[j];
      const double ux = c2 * f.uS[0] - s2 * f.uS[1], uy = s2 * f.uS[0] + c2 * f.uS[1];
      // (3.12) in the world's axes: w1^2 r + 2 w2 n x (vP - v2) + w2^2 d
      const double vx = O1.v[i] - w1 * ry - O2.v[i], vy = O1.v[j] + w1 * rx - O2.v[j];
      const double qx = w1 * w1 * rx - 2 * w2 * vy + w2 * w2 * dx, qy = w1 * w1 * ry + 2 * w2 * vx + w2 * w2 * dy;
      Eigen::Matrix2d R;
      for (int k = 0; k < f.n_translations; ++k) {
        const double ax = c2 * f.S[k][0] - s2 * f.S[k][1], ay = s2 * f.S[k][0] + c2 * f.S[k][1];
        block.C(k) = ax * (dx - ux) + ay * (dy - uy);
        block.Ct(k) = 0;
        block.Qhat(k) = ax * qx + ay * qy;
        if (f.pair) {
          R(0, k) = ax, R(1, k) = ay;
        } else {
          Vec3 v = Vec3::Zero(), m1 = Vec3::Zero(), m2 = Vec3::Zero();
          v[i] = ax, v[j] = ay, m1[n] = ay * rx - ax * ry, m2[n] = ax * dy - ay * dx;
          block.set(lock.side1_, k, v, m1);
          block.set(lock.side2_, k, Vec3(-v), m2);
        }
      }
      if (f.pair) {
        block.set_R(R);
        block.set_A(lock.side1_, Eigen::Vector2d(-ry, rx));
        block.set_A(lock.side2_, Eigen::Vector2d(dy, -dx));
      }
      if (lock.laws_ & with::p) {
        const ImposedTranslationT<double> D = imposed_translation(lock);
        for (int k = 0; k < f.n_translations; ++k) {
          const int a = f.axes[k];
          block.C(k) -= D.p[a], block.Ct(k) -= D.pd[a], block.Qhat(k) += D.pdd[a];
        }
      }
      row = f.n_translations;
    }
    if (!f.turn) continue;
    // (4.1) q2' q1 = (w, n r), e = q_D' q_S' q2' q1 q_P; only e0 and the part along the axis a
    const Vec3 e1 = O1.e.vec(), e2 = O2.e.vec();
    const double w = O2.e.w * O1.e.w + e2[n] * e1[n], r = O2.e.w * e1[n] - e2[n] * O1.e.w;
    double e0 = f.e[0] * w + f.e[1] * r, ea = f.e[2] * w + f.e[3] * r, turned = f.sign_P * w1 - f.sign_S * w2;
    double delta_d = 0, delta_dd = 0;
    if (lock.laws_ & with::qD) {
      const ImposedRotationT<double> D = imposed_rotation(lock);
      const double cD = D.q.w, sD = D.q.vec()[f.turn_axis], before = e0;
      e0 = cD * e0 + sD * ea, ea = cD * ea - sD * before;
      delta_d = D.w[f.turn_axis], delta_dd = D.a[f.turn_axis];
      turned -= delta_d;
    }
    // (4.11)-(4.14) with all angular velocities along a: e_a'' = e0/2 (rate of the turn) - turn^2/4 e_a
    block.C(row) = ea;
    block.Ct(row) = -0.5 * e0 * delta_d;
    block.Qhat(row) = 0.25 * turned * turned * ea + 0.5 * e0 * delta_dd;
    Vec3 m1 = Vec3::Zero(), m2 = Vec3::Zero();
    m1[n] = 0.5 * e0 * f.sign_P, m2[n] = -0.5 * e0 * f.sign_S;
    block.set(lock.side1_, row, Vec3(Vec3::Zero()), m1);
    block.set(lock.side2_, row, Vec3(Vec3::Zero()), m2);
  }
}

void MarkerLock::gather_plane(Group links, const Inputs& in, RowSpan out) const {
  MarkerLockGather{in}.in_plane(links, out);
}

}  // namespace lockstep
