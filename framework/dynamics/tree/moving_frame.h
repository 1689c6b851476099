// SPDX-License-Identifier: BSD-3-Clause
// MovingFrame: a frame on its way from a parent to a slot, one text for all numbers. V3, M3, Q4: vectors, matrices and
// quaternions of Eigen or of vec.h.
#pragma once

#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/number_kinds.h"

namespace lockstep {

/// A translation with its rates, and a turn with the rates in the axes that it turns: what carries a frame from another.
template <class V3, class Q4>
struct Carrying {
  V3 u, ud, udd;
  Q4 q;
  V3 w, a;
};
/// Small changes of it: of the translation and its velocity, of the turn (axes of the turned frame) and its rate.
template <class V3>
struct Changes {
  V3 u = zero_vector<V3>(), ud = u, turn = u, w = u;
};

/// World axes: axes, angular velocity; from the parent's centre of mass its place and velocity; accelerations beyond
/// the parent's own; with kVaries the variations of place, axes, velocity and angular velocity.
template <class V3, class M3, class Q4, bool kVaries>
struct MovingFrame {
  using Carrying = lockstep::Carrying<V3, Q4>;
  using Changes = lockstep::Changes<V3>;
  Q4 e;
  M3 A;
  V3 w, x = zero_vector<V3>(), v = x, a = x, al = x, dx = x, dphi = x, dv = x, dw = x;

  /// To a point at sign u, which moves in the frame.
  LOCKSTEP_INLINE void move(const Carrying& c, const Changes& d, double sign) {
    const V3 r = A * V3(sign * c.u), rd = A * V3(sign * c.ud);
    x = x + r, v = v + cross(w, r) + rd;
    a = a + cross(al, r) + cross(w, V3(cross(w, r))) + 2.0 * cross(w, rd) + A * V3(sign * c.udd);
    if constexpr (!kVaries) return;
    const V3 dr = cross(dphi, r) + A * V3(sign * d.u);
    dx = dx + dr;
    dv = dv + cross(dw, r) + cross(w, dr) + cross(dphi, rd) + A * V3(sign * d.ud);
  }
  /// To a frame turned by q against it.
  LOCKSTEP_INLINE void turn(const Carrying& c, const Changes& d) {
    e = e * c.q, A = rotation(e);
    const V3 W = A * c.w;
    al = al + A * c.a + cross(w, W);
    w = w + W;
    if constexpr (!kVaries) return;
    dphi = dphi + A * d.turn;
    dw = dw + cross(dphi, W) + A * d.w;
  }
  /// From a frame turned by q to the one against which it is turned.
  LOCKSTEP_INLINE void turn_back(const Carrying& c, const Changes& d) {
    const V3 W = A * c.w;
    w = w - W;
    al = al - (A * c.a + cross(w, W));
    if constexpr (kVaries) {
      dw = dw - (cross(dphi, W) + A * d.w);
      dphi = dphi - A * d.turn;
    }
    e = e * conjugate(c.q), A = rotation(e);
  }
};

/// A joint's own motion: translations with the laws' along the axes of S, and the free turn in the axes of P; and its
/// changes.
template <class V3, class Q4>
struct OwnMotion {
  Carrying<V3, Q4> slide, turn;
  Changes<V3> d_slide{}, d_turn{};
};

/// At coordinates q and velocities v; c, s: cosine and sine of half the angle of a hinge. With kVaries the changes by dq and
/// dv. Joint: as in JointMotion, and free_axis(i), the axis of S of its translation i; Numbers: likewise.
template <bool kVaries, class Joint, class Numbers, class T, class V3, class Q4>
LOCKSTEP_INLINE OwnMotion<V3, Q4> own_motion(const Joint& j, const Carrying<V3, Q4>& lock, Numbers q, Numbers v,
                                             Numbers dq, Numbers dv, const T& c, const T& s) {
  const V3 zero = zero_vector<V3>();
  OwnMotion<V3, Q4> o{lock, {zero, zero, zero, quaternion(c, zero), zero, zero}};
  const int n = j.n_slides();
  for (int i = 0; i < n; ++i) {
    const int axis = j.free_axis(i);
    component(o.slide.u, axis) = q[i], component(o.slide.ud, axis) = v[i];
    if constexpr (kVaries) component(o.d_slide.u, axis) = dq[i], component(o.d_slide.ud, axis) = dv[i];
  }
  if (j.turn() == TreeTurn::hinge) {
    const auto& axis = j.hinge();
    o.turn.q = quaternion(c, V3(s * axis)), o.turn.w = v[n] * axis;
    if constexpr (kVaries) o.d_turn.turn = dq[n] * axis, o.d_turn.w = dv[n] * axis;
  } else if (j.turn() == TreeTurn::ball) {
    const Q4 r = quaternion_at<V3>(q, n);
    o.turn.q = j.unit(r), o.turn.w = V3(v[n], v[n + 1], v[n + 2]);
    if constexpr (kVaries)
      o.d_turn.turn = turned_by(r, quaternion_at<V3>(dq, n)), o.d_turn.w = V3(dv[n], dv[n + 1], dv[n + 2]);
  }
  return o;
}

/// On the way: directions of the translations and axes of the turn, as those of Carried, and the point about which the
/// joint turns.
template <class V3>
struct JointAxes {
  V3 slides[3], turns[3], X;
};

/// From the parent to the slot: near marker, joint, and back from the far one. P = S moved by rho and turned by q_D r;
/// `lock`: q_D with its rates.
template <class Joint, class V3, class M3, class Q4, bool kVaries>
LOCKSTEP_INLINE JointAxes<V3> take_along(const Joint& j, const Carrying<V3, Q4>& near, const Carrying<V3, Q4>& far,
                                         const Carrying<V3, Q4>& lock, const OwnMotion<V3, Q4>& o,
                                         MovingFrame<V3, M3, Q4, kVaries>& f) {
  const Changes<V3> none;
  f.move(near, none, 1), f.turn(near, none);
  JointAxes<V3> out;
  M3 S, P;
  if (!j.reversed()) {
    S = f.A;
    f.move(o.slide, o.d_slide, 1);
    out.X = f.x;
    f.turn(lock, none), f.turn(o.turn, o.d_turn);
    P = f.A;
  } else {
    P = f.A, out.X = f.x;
    f.turn_back(o.turn, o.d_turn), f.turn_back(lock, none);
    S = f.A;
    f.move(o.slide, o.d_slide, -1);
  }
  f.turn_back(far, none), f.move(far, none, -1);
  const double sign = j.reversed() ? -1.0 : 1.0;
  for (int i = 0; i < j.n_slides(); ++i) out.slides[i] = sign * column_of(S, j.free_axis(i));
  if (j.turn() == TreeTurn::hinge) out.turns[0] = sign * (P * j.hinge());
  for (int i = 0; j.turn() == TreeTurn::ball && i < 3; ++i) out.turns[i] = sign * column_of(P, i);
  return out;
}

}  // namespace lockstep
