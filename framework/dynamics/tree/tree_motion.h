// How a joint of the tree carries its slot: the motion of a node from that of its parent, and the variation of it.
#pragma once

#include <cmath>

#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// The axes of a slot that carry the joint's translations, to world axes.
LOCKSTEP_INLINE const Mat3& slide_axes(const TreeNode& n, const Motion& p, const Motion& own) {
  return n.reversed ? own.A : p.A;
}

/// What the laws of a lock impose at an instant, in the axes of the slot that carries S, with the sign of the order of
/// the markers: of the slot against its parent. Written and read for nodes with laws only.
struct Imposed {
  Vec3 p, pd, pdd,  ///< translation, m, and its rates
      w, a,         ///< angular velocity, rad/s, and its derivative in the frame D, rad/s^2
      axis;         ///< axis of a hinge, in the parent's axes
  Quat q;           ///< q_D
};

/// Throws NonFiniteError and what the laws throw, with the link's name.
void laws_at(const TreeNode& n, double t, const VecX& s, Imposed& now);

/// Angular velocities of the slot against its parent per unit of the turn's velocities, world axes: three columns of a
/// ball, the first of a hinge.
LOCKSTEP_INLINE Mat3 turn_axes(const TreeNode& n, const Imposed& now, const Motion& p, const Motion& own) {
  Mat3 B = Mat3::Zero();
  if (n.turn == TreeTurn::hinge)
    B.col(0) = p.A * (n.imposed ? now.axis : n.axis);
  else if (n.turn == TreeTurn::ball)
    B = (n.reversed ? p.A : own.A) * n.axes->ball;
  return B;
}
/// A sum of the directions of the translations, by the numbers x.
LOCKSTEP_INLINE Vec3 along_slides(const TreeNode& n, const double* x) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < n.n_slides; ++k) sum += n.slide(k) * x[k];
  return sum;
}
/// The turn's velocities, or their variations, after those of the translations: of a hinge the first number.
LOCKSTEP_INLINE Vec3 turn_numbers(const TreeNode& n, const double* v) {
  const double* a = v + n.n_slides;
  if (n.turn == TreeTurn::ball) return {a[0], a[1], a[2]};
  return {n.turn == TreeTurn::hinge ? a[0] : 0.0, 0.0, 0.0};
}

/// What a joint adds to its parent's motion, world axes. The joint acts at a point that is fixed in the slot that does
/// not carry the slides.
struct Carried {
  Mat3 turn_axes;  ///< as the function
  Vec3 d1,         ///< from the parent's mass centre to that point, m
      d2,          ///< from there to the slot's mass centre, m
      slide,       ///< velocity of the translations, m/s
      turn,        ///< angular velocity against the parent, rad/s: of the coordinates
      law,         ///< and of the laws; only of a node with laws
      w;           ///< angular velocity of the slot, rad/s
};

/// Cosine and sine of half the angle of a hinge; of another joint not read.
struct HalfTurn {
  double c = 1, s = 0;
};
LOCKSTEP_INLINE double half_angle(const TreeNode& n, const double* q) {
  return n.turn == TreeTurn::hinge ? 0.5 * q[n.n_slides] : 0.0;
}
LOCKSTEP_INLINE HalfTurn half_turn(const TreeNode& n, const double* q) {
  const double half = half_angle(n, q);
  return {std::cos(half), std::sin(half)};
}

/// Writes the orientation of a node at its coordinates q.
LOCKSTEP_INLINE void orient(const TreeNode& n, const Imposed& now, const double* q, const HalfTurn& half,
                            const Motion& p, Motion& out) {
  const double* a = q + n.n_slides;
  if (n.imposed) {
    Quat r = now.q;
    if (n.turn == TreeTurn::hinge)
      r = r * Quat::from(half.c, Vec3(half.s * n.hinge));
    else if (n.turn == TreeTurn::ball)
      r = r * normalized(Quat{a[0], a[1], a[2], a[3]});
    out.e = p.e * (n.near_q * (n.reversed ? conjugate(r) : r) * conjugate(n.far_q));
  } else if (n.turn == TreeTurn::hinge) {
    const auto [c, s] = half;
    out.e = p.e * Quat{c * n.K0.w + s * n.K1.w, c * n.K0.x + s * n.K1.x, c * n.K0.y + s * n.K1.y,
                       c * n.K0.z + s * n.K1.z};
  } else if (n.turn == TreeTurn::none) {
    out.e = p.e * n.K0;
  } else {
    const Quat r = normalized(Quat{a[0], a[1], a[2], a[3]});
    out.e = p.e * n.near_q * (n.reversed ? conjugate(r) : r) * conjugate(n.far_q);
  }
  // Products of unit quaternions are of unit length to round-off; along a chain that adds up: one step of Newton's.
  const double unit = 1.5 - 0.5 * norm2(out.e);
  out.e = {unit * out.e.w, unit * out.e.x, unit * out.e.y, unit * out.e.z};
  out.A = rotation(out.e);
}

/// What the joint of a node adds at its coordinates q and velocities v. `p`, `own`: motions of the parent and, of which
/// the orientation is read, of the node; `wp`: angular velocity of the parent, world axes, rad/s.
LOCKSTEP_INLINE Carried carried(const TreeNode& n, const Imposed& now, const double* q, const double* v,
                                const Motion& p, const Vec3& wp, const Motion& own) {
  Carried c;
  c.turn_axes = turn_axes(n, now, p, own);
  c.d1 = p.A * n.near_u;
  c.d2 = -(own.A * n.far_u);
  c.slide.setZero();
  if (n.n_slides > 0) {
    const Mat3& S = slide_axes(n, p, own);
    (n.reversed ? c.d2 : c.d1) += S * along_slides(n, q);
    c.slide = S * along_slides(n, v);
  }
  if (n.turn == TreeTurn::hinge)
    c.turn = c.turn_axes.col(0) * v[n.n_slides];
  else
    c.turn = c.turn_axes * turn_numbers(n, v);
  c.w = wp + c.turn;
  if (n.imposed) {
    const Mat3& S = slide_axes(n, p, own);
    (n.reversed ? c.d2 : c.d1) += S * now.p;
    c.slide += S * now.pd;
    c.law = S * now.w;
    c.w += c.law;
  }
  return c;
}

/// Writes the motion of a node at a state, and returns what its joint adds. `p`, `wp`: motion of the parent, its angular
/// velocity in world axes, rad/s.
LOCKSTEP_INLINE Carried carry(const TreeNode& n, const Imposed& now, const State& y, const HalfTurn& half,
                              const Motion& p, const Vec3& wp, Motion& out) {
  const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v;
  orient(n, now, q, half, p, out);
  const Carried c = carried(n, now, q, v, p, wp, out);
  out.w = out.A.transpose() * c.w;
  out.x = p.x + c.d1 + c.d2;
  out.v = p.v + cross(wp, c.d1) + c.slide + cross(c.w, c.d2);
  return c;
}

LOCKSTEP_INLINE Carried carry(const TreeNode& n, const State& y, const Motion& p, const Vec3& wp, Motion& out) {
  Imposed now;
  if (n.imposed) laws_at(n, y.t, y.s, now);
  return carry(n, now, y, half_turn(n, y.q.data() + n.first_q), p, wp, out);
}

/// Variation of a node's motion, world axes.
struct NodeVariation {
  Vec3 x = Vec3::Zero(),   ///< of the mass centre
      phi = Vec3::Zero(),  ///< rotation vector
      v = Vec3::Zero(),    ///< of its velocity
      w = Vec3::Zero();    ///< of the angular velocity
};

/// The variation of a node under dy of its own coordinates; laws stay as they are. `p`, `own`: motions of the parent and the node, `dp`:
/// the variation of the parent's.
inline NodeVariation vary(const TreeNode& n, const State& y, const StateRate& dy, const Motion& p, const Motion& own,
                          const NodeVariation& dp) {
  const double *q = y.q.data() + n.first_q, *v = y.v.data() + n.first_v;
  const double *dq = dy.q.data() + n.first_q, *dv = dy.v.data() + n.first_v;
  const Vec3 wp = p.A * p.w;
  Imposed now;
  if (n.imposed) laws_at(n, y.t, y.s, now);
  const Carried c = carried(n, now, q, v, p, wp, own);
  Vec3 turned = turn_numbers(n, dq);  // of a ball: twice the vector part of r' dr
  if (n.turn == TreeTurn::ball) {
    const double *a = q + n.n_slides, *da = dq + n.n_slides;
    const Quat r{a[0], a[1], a[2], a[3]};
    turned = 2.0 / norm2(r) * (conjugate(r) * Quat{da[0], da[1], da[2], da[3]}).vec();
  }
  NodeVariation d;
  d.phi = dp.phi + c.turn_axes * turned;
  const bool turns_with_child = n.turn == TreeTurn::ball && !n.reversed;
  d.w = dp.w + c.turn_axes * turn_numbers(n, dv) + cross(turns_with_child ? d.phi : dp.phi, c.turn);
  if (n.imposed) d.w += cross(n.reversed ? d.phi : dp.phi, c.law);
  const Mat3& S = slide_axes(n, p, own);
  Vec3 d1 = cross(dp.phi, c.d1), d2 = cross(d.phi, c.d2);
  (n.reversed ? d2 : d1) += S * along_slides(n, dq);
  const Vec3 slide = cross(n.reversed ? d.phi : dp.phi, c.slide) + S * along_slides(n, dv);
  d.x = dp.x + d1 + d2;
  d.v = dp.v + cross(dp.w, c.d1) + cross(wp, d1) + slide + cross(d.w, c.d2) + cross(c.w, d2);
  return d;
}

}  // namespace lockstep
