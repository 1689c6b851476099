#include "framework/dynamics/tree/moving_markers.h"

#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

JointLaws joint_laws_at(const TreeNode& n, double t, const VecX& s) {
  JointLaws now;
  const std::span<const double> own =
      n.n_s > 0 ? std::span<const double>(s.data() + n.first_s, static_cast<std::size_t>(n.n_s))
                : std::span<const double>();
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

// Small changes of what moves a frame: of the displacement, its velocity, the rotation (axes of the turned frame) and
// its rate.
struct Changes {
  Vec3 u = Vec3::Zero(), ud = Vec3::Zero(), turn = Vec3::Zero(), w = Vec3::Zero();
};

// A frame, world axes; accelerations beyond the parent's own; and how it varies.
struct Moved {
  Quat e;
  Mat3 A;
  Vec3 x, v, w, a = Vec3::Zero(), al = Vec3::Zero();
  NodeVariation d;

  Moved(const Motion& m, const Vec3& w_world) : e(m.e), A(m.A), x(m.x), v(m.v), w(w_world) {}

  // To a point at u, which moves in the frame; `sign` -1: from it.
  void move(const Vec3& u, const Vec3& ud, const Vec3& udd, const Changes& c = {}, double sign = 1) {
    const Vec3 r = A * u, rd = A * ud, dr = cross(d.phi, r) + A * c.u;
    x += sign * r;
    v += sign * (cross(w, r) + rd);
    a += sign * (cross(al, r) + cross(w, cross(w, r)) + 2.0 * cross(w, rd) + A * udd);
    d.x += sign * dr;
    d.v += sign * (cross(d.w, r) + cross(w, dr) + cross(d.phi, rd) + A * c.ud);
  }
  // To a frame turned by q against it, with the rates of q in its own axes.
  void turn(const Quat& q, const Vec3& rate, const Vec3& rate_d, const Changes& c = {}) {
    e = e * q, A = rotation(e);
    const Vec3 W = A * rate;
    al += A * rate_d + cross(w, W);
    w += W;
    d.phi += A * c.turn;
    d.w += cross(d.phi, W) + A * c.w;
  }
  // From a frame turned by q to the one against which it is turned.
  void turn_back(const Quat& q, const Vec3& rate, const Vec3& rate_d, const Changes& c = {}) {
    const Vec3 W = A * rate;
    w -= W;
    al -= A * rate_d + cross(w, W);
    d.w -= cross(d.phi, W) + A * c.w;
    d.phi -= A * c.turn;
    e = e * conjugate(q), A = rotation(e);
  }
};

// The joint's own motion: translations with the laws' along the axes of S, and the free turn in the axes of P.
struct JointMotion {
  ImposedTranslation x;
  Quat r;
  Vec3 w = Vec3::Zero();
  Changes slide, turn;
};

JointMotion joint_motion(const TreeNode& n, const JointLaws& now, const State& y, const StateRate* dy) {
  const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v;
  JointMotion o{now.x, {}, Vec3::Zero(), {}, {}};
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    if (includes(n.rows, row_bit(i))) continue;
    o.x.p[i] = q[k], o.x.pd[i] = v[k];
    if (dy != nullptr) o.slide.u[i] = dy->q[n.first_q + k], o.slide.ud[i] = dy->v[n.first_v + k];
    ++k;
  }
  if (n.turn == TreeTurn::hinge) {
    o.r = Quat::from(std::cos(0.5 * q[k]), Vec3(std::sin(0.5 * q[k]) * n.hinge));
    o.w = v[k] * n.hinge;
    if (dy != nullptr) o.turn.turn = dy->q[n.first_q + k] * n.hinge, o.turn.w = dy->v[n.first_v + k] * n.hinge;
  } else if (n.turn == TreeTurn::ball) {
    const Quat r{q[k], q[k + 1], q[k + 2], q[k + 3]};
    o.r = normalized(r);
    o.w = Vec3(v[k], v[k + 1], v[k + 2]);
    if (dy != nullptr) {
      const double *dq = dy->q.data() + n.first_q + k, *dv = dy->v.data() + n.first_v + k;
      o.turn.turn = 2.0 / norm2(r) * (conjugate(r) * Quat{dq[0], dq[1], dq[2], dq[3]}).vec();
      o.turn.w = Vec3(dv[0], dv[1], dv[2]);
    }
  }
  return o;
}

// From the parent to the slot: near marker, joint, and back from the far one. P = S moved by rho and turned by q_D r.
Moved moved(const TreeNode& n, const State& y, const StateRate* dy, Moved f, MovedNode& out) {
  const JointLaws now = joint_laws_at(n, y.t, y.s);
  const JointMotion o = joint_motion(n, now, y, dy);
  const Vec3 zero = Vec3::Zero();
  Mat3 S, P;
  f.move(now.near.u, now.near.ud, now.near.udd);
  f.turn(now.near.q, now.near.w, now.near.a);
  if (!n.reversed) {
    S = f.A;
    f.move(o.x.p, o.x.pd, o.x.pdd, o.slide);
    out.X = f.x;
    f.turn(now.D.q, now.D.w, now.D.a);
    f.turn(o.r, o.w, zero, o.turn);
    P = f.A;
  } else {
    P = f.A, out.X = f.x;
    f.turn_back(o.r, o.w, zero, o.turn);
    f.turn_back(now.D.q, now.D.w, now.D.a);
    S = f.A;
    f.move(o.x.p, o.x.pd, o.x.pdd, o.slide, -1);
  }
  f.turn_back(now.far.q, now.far.w, now.far.a);
  f.move(now.far.u, now.far.ud, now.far.udd, {}, -1);

  const double sign = n.reversed ? -1.0 : 1.0;
  std::size_t k = 0;
  for (int i = 0; i < 3; ++i)
    if (!includes(n.rows, row_bit(i))) out.slide[k++] = sign * S.col(i);
  out.turn_axes.setZero();
  if (n.turn == TreeTurn::hinge) out.turn_axes.col(0) = sign * (P * n.hinge);
  if (n.turn == TreeTurn::ball) out.turn_axes = sign * P;
  return f;
}

}  // namespace

MovedNode carry_moving(const TreeNode& n, const State& y, const Motion& p, const Vec3& wp, Motion& out) {
  MovedNode node;
  const Moved f = moved(n, y, nullptr, Moved(p, wp), node);
  out.e = normalized(f.e), out.A = rotation(out.e);
  out.x = f.x, out.v = f.v, out.w = out.A.transpose() * f.w;
  node.w = f.w, node.r = f.x - p.x, node.ca = f.a, node.cal = f.al;
  return node;
}

NodeVariation vary_moving(const TreeNode& n, const State& y, const StateRate& dy, const Motion& p,
                          const NodeVariation& dp) {
  Moved parent(p, p.A * p.w);
  parent.d = dp;
  MovedNode node;
  return moved(n, y, &dy, parent, node).d;
}

MovedCoordinates read_moving(const TreeNode& n, double t, const VecX& s, const Motion& p, const Motion& own) {
  const JointLaws now = joint_laws_at(n, t, s);
  Moved near(p, p.A * p.w), far(own, own.A * own.w);
  near.move(now.near.u, now.near.ud, now.near.udd), near.turn(now.near.q, now.near.w, now.near.a);
  far.move(now.far.u, now.far.ud, now.far.udd), far.turn(now.far.q, now.far.w, now.far.a);
  const Moved &P = n.reversed ? near : far, &S = n.reversed ? far : near;
  const Vec3 d = P.x - S.x;
  MovedCoordinates c;
  c.rho = S.A.transpose() * d;
  c.rhod = S.A.transpose() * (P.v - S.v - cross(S.w, d));
  c.r = conjugate(now.D.q) * (conjugate(S.e) * P.e);
  c.w = P.A.transpose() * (P.w - S.w - S.A * (now.D.A * now.D.w));
  return c;
}

}  // namespace lockstep
