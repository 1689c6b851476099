// SPDX-License-Identifier: BSD-3-Clause
// The motion of a node of the tree, of doubles.
#pragma once

#include <cmath>

#include "framework/dynamics/tree/joint_motion.h"
#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// What the laws of a lock impose at an instant, in the axes of the slot that carries S, with the sign of the order of
/// the markers: of the slot against its parent. Written and read for nodes with laws only.
struct Imposed {
  Vec3 p, pd, pdd,  ///< translation, m, and its rates
      w, a,         ///< angular velocity, rad/s, and its derivative in the frame D, rad/s^2
      axis;         ///< axis of a hinge, in the parent's axes
  Quat q;           ///< q_D
};

/// Throws NonFiniteError and what the laws throw, with the link's name.
LOCKSTEP_API void laws_at(const TreeNode& n, double t, const VecX& s, Imposed& now);

/// A node and its laws, for JointMotion.
struct NodeJoint {
  using L = Vec3;
  using W = Vec3;
  static constexpr bool kBalls = true;
  using M3 = Mat3;
  using Q4 = Quat;
  const TreeNode& n;
  const Imposed& now;

  LOCKSTEP_INLINE int n_slides() const { return n.n_slides; }
  LOCKSTEP_INLINE TreeTurn turn() const { return n.turn; }
  LOCKSTEP_INLINE bool reversed() const { return n.reversed; }
  LOCKSTEP_INLINE bool has_laws() const { return n.imposed != nullptr; }
  LOCKSTEP_INLINE const Vec3& near_u() const { return n.near_u; }
  LOCKSTEP_INLINE const Vec3& far_u() const { return n.far_u; }
  LOCKSTEP_INLINE const Vec3& axis() const { return n.imposed ? now.axis : n.axis; }
  LOCKSTEP_INLINE const Quat& K0() const { return n.K0; }
  LOCKSTEP_INLINE const Quat& K1() const { return n.K1; }
  LOCKSTEP_INLINE const Quat& near_q() const { return n.near_q; }
  LOCKSTEP_INLINE const Quat& far_q() const { return n.far_q; }
  LOCKSTEP_INLINE const Vec3& hinge() const { return n.hinge; }
  LOCKSTEP_INLINE const Vec3& slide(int i) const { return n.slide(i); }
  /// Axis of S of the translation i.
  LOCKSTEP_INLINE int free_axis(int i) const {
    int axis = 0;
    for (int left = i;; ++axis)
      if (!includes(n.rows, row_bit(axis)) && left-- == 0) return axis;
  }
  LOCKSTEP_INLINE Vec3 ball(int i) const { return n.axes->ball.col(i); }
  LOCKSTEP_INLINE const Vec3& p() const { return now.p; }
  LOCKSTEP_INLINE const Vec3& pd() const { return now.pd; }
  LOCKSTEP_INLINE const Vec3& pdd() const { return now.pdd; }
  LOCKSTEP_INLINE const Vec3& w() const { return now.w; }
  LOCKSTEP_INLINE const Vec3& a() const { return now.a; }
  LOCKSTEP_INLINE const Quat& q() const { return now.q; }
  LOCKSTEP_INLINE Quat unit(const Quat& r) const { return normalized(r); }
};
using NodeMotion = JointMotion<NodeJoint, const double*>;
LOCKSTEP_INLINE NodeMotion motion_of(const NodeJoint& j, const State& y) {
  return {j, y.q.data() + j.n.first_q, y.v.data() + j.n.first_v};
}

LOCKSTEP_INLINE double half_angle(const TreeNode& n, const double* q) {
  return n.turn == TreeTurn::hinge ? 0.5 * q[n.n_slides] : 0.0;
}

/// Writes the motion of a node at a state, and returns what its joint adds. c, s: cosine and sine of half_angle(); `p`,
/// `wp`: motion of the parent, its angular velocity in world axes, rad/s.
LOCKSTEP_INLINE Carried<Vec3> carry(const NodeMotion& m, double c, double s, const Motion& p, const Vec3& wp,
                                    Motion& out) {
  out.e = m.orientation(c, s, p.e), out.A = rotation(out.e);
  const Carried<Vec3> add = m.carried(p.A, out.A, wp);
  out.w = out.A.transpose() * add.w;
  out.x = p.x + add.d1 + add.d2, out.v = p.v + m.velocity(add, wp);
  return add;
}
LOCKSTEP_INLINE void carry(const TreeNode& n, const State& y, const Motion& p, const Vec3& wp, Motion& out) {
  Imposed now;
  if (n.imposed) laws_at(n, y.t, y.s, now);
  const double half = half_angle(n, y.q.data() + n.first_q);
  const NodeJoint joint{n, now};
  carry(motion_of(joint, y), std::cos(half), std::sin(half), p, wp, out);
}

using NodeVariation = Variation<Vec3>;

}  // namespace lockstep
