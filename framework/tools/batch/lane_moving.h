// Joints of the tree whose markers move on their bodies by laws, in lanes: dynamics/tree/moving_markers.cpp on packs.
// Private to the room.
#pragma once

#include "framework/tools/batch/lane_math.h"
#include "framework/tools/batch/tree_plan.h"

namespace lockstep::lanes::LOCKSTEP_SET {

LOCKSTEP_LANE V3 column(const M3& A, int k) {
  if (k == 0) return {A.r0.x, A.r1.x, A.r2.x};
  if (k == 1) return {A.r0.y, A.r1.y, A.r2.y};
  return {A.r0.z, A.r1.z, A.r2.z};
}
LOCKSTEP_LANE V& number(V3& a, int k) { return k == 0 ? a.x : k == 1 ? a.y : a.z; }

/// A translation with its rates, and a turn with the rates in the axes that it turns: what carries a frame from another.
struct Carrying {
  V3 u, ud, udd;
  Q4 q;
  V3 w, a;
};
LOCKSTEP_LANE Carrying load_carrying(const double* p, std::size_t at) {
  return {load3(p, at + marked::u), load3(p, at + marked::ud), load3(p, at + marked::udd),
          load4(p, at + marked::q), load3(p, at + marked::w),  load3(p, at + marked::a)};
}
/// Small changes of it: of the translation and its velocity, of the turn (axes of the turned frame) and its rate.
struct Changes {
  V3 u{V{}, V{}, V{}}, ud = u, turn = u, w = u;
};

/// A frame on its way from a parent to a slot, world axes: axes, angular velocity; from the parent's mass centre its place
/// and velocity; accelerations beyond the parent's own; and how the last but these vary.
struct MovingFrame {
  Q4 e;
  M3 A;
  V3 w, x, v, a, al, dx, dphi, dv, dw;

  /// To a point at sign u, which moves in the frame.
  LOCKSTEP_LANE void move(const Carrying& c, const Changes& d, double sign) {
    const V3 r = A * (sign * c.u), rd = A * (sign * c.ud), dr = cross(dphi, r) + A * (sign * d.u);
    x = x + r, v = v + cross(w, r) + rd;
    a = a + cross(al, r) + cross(w, cross(w, r)) + 2.0 * cross(w, rd) + A * (sign * c.udd);
    dx = dx + dr;
    dv = dv + cross(dw, r) + cross(w, dr) + cross(dphi, rd) + A * (sign * d.ud);
  }
  /// To a frame turned by q against it.
  LOCKSTEP_LANE void turn(const Carrying& c, const Changes& d) {
    e = e * c.q, A = rotation(e);
    const V3 W = A * c.w;
    al = al + A * c.a + cross(w, W);
    w = w + W;
    dphi = dphi + A * d.turn;
    dw = dw + cross(dphi, W) + A * d.w;
  }
  /// From a frame turned by q to the one against which it is turned.
  LOCKSTEP_LANE void turn_back(const Carrying& c, const Changes& d) {
    const V3 W = A * c.w;
    w = w - W;
    al = al - (A * c.a + cross(w, W));
    dw = dw - (cross(dphi, W) + A * d.w);
    dphi = dphi - A * d.turn;
    e = e * conjugate(c.q), A = rotation(e);
  }
};

/// The joint's own motion: translations with the laws' along the axes of S, and the free turn in the axes of P; and its
/// changes.
struct OwnMotion {
  Carrying slide, turn;
  Changes d_slide, d_turn;
};
/// dy: changes of the coordinates; null: none.
LOCKSTEP_LANE OwnMotion own_motion(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k,
                                   const Carrying& lock, const double* dy) {
  const double *q = z.y + kLanes * n.q, *v = z.y + kLanes * (plan.n_q + n.v);
  const double *dq = dy ? dy + kLanes * n.q : nullptr, *dv = dy ? dy + kLanes * (plan.n_q + n.v) : nullptr;
  const V3 zero{V{}, V{}, V{}};
  OwnMotion o{lock, {zero, zero, zero, Q4{V{} + 1.0, zero}, zero, zero}, {}, {}};
  const auto slides = static_cast<std::size_t>(n.n_slides);
  for (std::size_t i = 0; i < slides; ++i) {
    const int axis = n.slides[i];
    number(o.slide.u, axis) = load(q, i), number(o.slide.ud, axis) = load(v, i);
    if (dy) number(o.d_slide.u, axis) = load(dq, i), number(o.d_slide.ud, axis) = load(dv, i);
  }
  if (n.turn == TreeTurn::hinge) {
    const V3 axis = load3(z.more + kLanes * n.more, more::hinge);
    o.turn.q = Q4{load(z.cosine, k), load(z.sine, k) * axis}, o.turn.w = load(v, slides) * axis;
    if (dy) o.d_turn.turn = load(dq, slides) * axis, o.d_turn.w = load(dv, slides) * axis;
  } else if (n.turn == TreeTurn::ball) {
    const Q4 r = load4(q, slides);
    const V size2 = r.w * r.w + dot(r.v, r.v), unit = 1.0 / square_root(size2);
    o.turn.q = unit * r, o.turn.w = load3(v, slides);
    if (dy) {  // twice the vector part of r' dr
      const Q4 dr = load4(dq, slides);
      o.d_turn.turn = (2.0 / size2) * (r.w * dr.v - dr.w * r.v - cross(r.v, dr.v));
      o.d_turn.w = load3(dv, slides);
    }
  }
  return o;
}

/// Axes of S and of P, and the point about which the joint turns, on the way.
struct JointFrames {
  M3 S, P;
  V3 X;
};

/// From the parent to the slot: near marker, joint, and back from the far one. P = S moved by rho and turned by q_D r.
LOCKSTEP_LANE JointFrames take_along(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k,
                                     const double* dy, MovingFrame& f) {
  const double* law = z.law + kLanes * n.law;
  const Carrying near = load_carrying(law, marked::near), far = load_carrying(law, marked::far),
                 lock = load_carrying(law, marked::lock);
  const OwnMotion o = own_motion(n, plan, z, k, lock, dy);
  JointFrames out;
  f.move(near, {}, 1), f.turn(near, {});
  if (!n.reversed) {
    out.S = f.A;
    f.move(o.slide, o.d_slide, 1);
    out.X = f.x;
    f.turn(lock, {}), f.turn(o.turn, o.d_turn);
    out.P = f.A;
  } else {
    out.P = f.A, out.X = f.x;
    f.turn_back(o.turn, o.d_turn), f.turn_back(lock, {});
    out.S = f.A;
    f.move(o.slide, o.d_slide, -1);
  }
  f.turn_back(far, {}), f.move(far, {}, -1);
  return out;
}

/// The frame of a parent, whose moving:: and varied:: these are; without the latter nothing varies.
LOCKSTEP_LANE MovingFrame frame_of(const double* p, const double* dp) {
  const V3 zero{V{}, V{}, V{}};
  MovingFrame f{
      load4(p, moving::e), load9(p, moving::A), load3(p, moving::w), zero, zero, zero, zero, zero, zero, zero, zero};
  if (!dp) return f;
  f.dx = load3(dp, varied::x), f.dphi = load3(dp, varied::phi), f.dv = load3(dp, varied::v),
  f.dw = load3(dp, varied::w);
  return f;
}

/// Writes the motion of a node and the axes of its coordinates, as carry() does.
LOCKSTEP_LANE void carry_moving(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k) {
  const double* p = z.moving + kLanes * moving::size * static_cast<std::size_t>(n.parent + 1);
  double *b = z.moving + kLanes * moving::size * (k + 1), *d = z.dof + kLanes * dof::size * n.v;
  MovingFrame f = frame_of(p, nullptr);
  const JointFrames at = take_along(n, plan, z, k, nullptr, f);
  const V unit = 1.5 - 0.5 * (f.e.w * f.e.w + dot(f.e.v, f.e.v));  // one step of Newton's, as in orientation()
  const Q4 e = unit * f.e;
  const M3 A = rotation(e);
  store(b, moving::e, e.w), store3(b, moving::e + 1, e.v);
  store3(b, moving::A, A.r0), store3(b, moving::A + 3, A.r1), store3(b, moving::A + 6, A.r2);
  store3(b, moving::w, f.w), store3(b, moving::r, f.x), store3(b, moving::ca, f.a), store3(b, moving::cal, f.al);

  const double sign = n.reversed ? -1.0 : 1.0;
  const auto slides = static_cast<std::size_t>(n.n_slides), n_v = static_cast<std::size_t>(n.n_v());
  for (std::size_t i = 0; i < slides; ++i) {
    store3(d, dof::size * i + dof::l, sign * column(at.S, n.slides[i]));
    store3(d, dof::size * i + dof::n, V3{V{}, V{}, V{}});
  }
  for (std::size_t i = slides; i < n_v; ++i) {
    const V3 axis = sign * (n.turn == TreeTurn::hinge ? at.P * load3(z.more + kLanes * n.more, more::hinge)
                                                      : column(at.P, static_cast<int>(i - slides)));
    store3(d, dof::size * i + dof::n, axis), store3(d, dof::size * i + dof::l, cross(axis, f.x - at.X));
  }
  if (!z.with_positions) return;
  store3(b, moving::x, load3(p, moving::x) + f.x), store3(b, moving::v, load3(p, moving::v) + f.v);
}

/// How dy moves a node: writes its varied::.
LOCKSTEP_LANE void vary_moving(const LaneNode& n, const TreePlan& plan, const TreeNumbers& z, std::size_t k,
                               const double* dy) {
  const auto parent = static_cast<std::size_t>(n.parent + 1);
  MovingFrame f = frame_of(z.moving + kLanes * moving::size * parent, z.varied + kLanes * varied::size * parent);
  take_along(n, plan, z, k, dy, f);
  double* own = z.varied + kLanes * varied::size * (k + 1);
  store3(own, varied::x, f.dx), store3(own, varied::phi, f.dphi);
  store3(own, varied::v, f.dv), store3(own, varied::w, f.dw);
}

}  // namespace lockstep::lanes::LOCKSTEP_SET
