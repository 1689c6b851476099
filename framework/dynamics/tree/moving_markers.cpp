// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/tree/moving_markers.h"

#include <lockstep/author/relative.h>
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

JointLaws joint_laws_at(const TreeNode& n, double t, const VecX& s) {
  JointLaws now;
  const std::span<const double> own = n.own_states(s);
  named(*n.lock, t, [&] {
    now.near = n.moving->near.at(t), now.far = n.moving->far.at(t);
    if (n.imposed) now.x = n.imposed->translation(t, own), now.D = n.imposed->rotation(t, own);
  });
  for (int k = 0; k < 3; ++k)
    if (!includes(n.rows, row_bit(k))) now.x.p[k] = now.x.pd[k] = now.x.pdd[k] = 0;
  Vec3 all = now.x.p + now.x.pd + now.x.pdd + now.D.w + now.D.a + now.D.q.vec();
  for (const MarkerMotion* m : {&now.near, &now.far}) all += m->u + m->ud + m->udd + m->w + m->a + m->q.vec();
  if (!all.allFinite()) refuse_laws(*n.lock, t);
  return now;
}

namespace {

template <bool kVaries>
using Frame = MovingFrame<Vec3, Mat3, Quat, kVaries>;
using Carried3 = Carrying<Vec3, Quat>;

Carried3 carrying(const MarkerMotion& m) { return {m.u, m.ud, m.udd, m.q, m.w, m.a}; }
Carried3 carrying(const JointLaws& now) { return {now.x.p, now.x.pd, now.x.pdd, now.D.q, now.D.w, now.D.a}; }
// Of a motion, its own place: x is that of the world.
Frame<false> frame_of(const Motion& m) {
  Frame<false> f{m.e, m.A, m.A * m.w};
  f.x = m.x, f.v = m.v;
  return f;
}

// dy: changes of the coordinates; null: none.
template <bool kVaries>
JointAxes<Vec3> take_along(const TreeNode& n, const State& y, const StateRate* dy, Frame<kVaries>& f) {
  const JointLaws now = joint_laws_at(n, y.t, y.s);
  const Carried3 lock = carrying(now);
  const Imposed none;
  const NodeJoint joint{n, none};
  const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v, half = half_angle(n, q);
  const double *dq = dy ? dy->q.data() + n.first_q : nullptr, *dv = dy ? dy->v.data() + n.first_v : nullptr;
  const auto own = own_motion<kVaries>(joint, lock, q, v, dq, dv, std::cos(half), std::sin(half));
  return take_along(joint, carrying(now.near), carrying(now.far), lock, own, f);
}

}  // namespace

MovedNode carry_moving(const TreeNode& n, const State& y, const Motion& p, const Vec3& wp, Motion& out) {
  Frame<false> f{p.e, p.A, wp};
  const JointAxes<Vec3> at = take_along(n, y, nullptr, f);
  out.e = normalized(f.e), out.A = rotation(out.e);
  out.x = p.x + f.x, out.v = p.v + f.v, out.w = out.A.transpose() * f.w;
  return {f.w, f.x, f.a, f.al, at};
}

NodeVariation vary_moving(const TreeNode& n, const State& y, const StateRate& dy, const Motion& p,
                          const NodeVariation& dp) {
  Frame<true> f{p.e, p.A, p.A * p.w};
  f.dx = dp.x, f.dphi = dp.phi, f.dv = dp.v, f.dw = dp.w;
  take_along(n, y, &dy, f);
  return {f.dx, f.dphi, f.dv, f.dw};
}

MovedCoordinates read_moving(const TreeNode& n, double t, const VecX& s, const Motion& p, const Motion& own) {
  const JointLaws now = joint_laws_at(n, t, s);
  Frame<false> near = frame_of(p), far = frame_of(own);
  near.move(carrying(now.near), {}, 1), near.turn(carrying(now.near), {});
  far.move(carrying(now.far), {}, 1), far.turn(carrying(now.far), {});
  const Frame<false>&P = n.reversed ? near : far, &S = n.reversed ? far : near;
  const Vec3 d = P.x - S.x;
  return {.rho = S.A.transpose() * d,
          .rhod = S.A.transpose() * (P.v - S.v - cross(S.w, d)),
          .w = P.A.transpose() * (P.w - S.w - S.A * (now.D.A * now.D.w)),
          .r = conjugate(now.D.q) * (conjugate(S.e) * P.e)};
}

}  // namespace lockstep
