// How a joint of the tree carries its slot: the motion of a node from that of its parent, and the variation of it.
#pragma once

#include <cmath>

#include "framework/dynamics/tree/joint_tree.h"

namespace lockstep {

/// What a joint adds to its parent's motion, world axes. The joint acts at a point that is fixed in the slot that does
/// not carry the slides.
struct Carried {
  Vec3 d1,    ///< from the parent's mass centre to that point, m
      d2,     ///< from there to the slot's mass centre, m
      slide,  ///< velocity of the translations, m/s
      turn,   ///< angular velocity against the parent, rad/s
      w;      ///< angular velocity of the slot, rad/s
};

/// Writes the motion of a node at its coordinates q and velocities v (those of the node alone). `p`, `wp`: motion of
/// the parent, its angular velocity in world axes, rad/s.
LOCKSTEP_INLINE void carry(const TreeNode& n, const double* q, const double* v, const Motion& p, const Vec3& wp,
                           Motion& out, Carried& c) {
  const double *a = q + n.n_slides, *ad = v + n.n_slides;
  if (n.turn == TreeTurn::hinge) {
    const double co = std::cos(0.5 * a[0]), s = std::sin(0.5 * a[0]);
    out.e = p.e * Quat{co * n.K0.w + s * n.K1.w, co * n.K0.x + s * n.K1.x, co * n.K0.y + s * n.K1.y,
                       co * n.K0.z + s * n.K1.z};
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

  c.d1 = p.A * n.near_u;
  c.d2 = -(out.A * n.far_u);
  c.slide.setZero(), c.turn.setZero();
  if (n.n_slides > 0) {
    Vec3 rho = n.slide[0] * q[0], rhod = n.slide[0] * v[0];
    for (int k = 1; k < n.n_slides; ++k)
      rho += n.slide[static_cast<std::size_t>(k)] * q[k], rhod += n.slide[static_cast<std::size_t>(k)] * v[k];
    const Mat3& S = n.reversed ? out.A : p.A;
    (n.reversed ? c.d2 : c.d1) += S * rho;
    c.slide = S * rhod;
  }
  if (n.turn == TreeTurn::hinge)
    c.turn = (p.A * n.axis) * ad[0];
  else if (n.turn == TreeTurn::ball)
    c.turn = (n.reversed ? p.A : out.A) * (n.ball * Vec3(ad[0], ad[1], ad[2]));
  c.w = wp + c.turn;
  out.w = out.A.transpose() * c.w;
  out.x = p.x + c.d1 + c.d2;
  out.v = p.v + cross(wp, c.d1) + c.slide + cross(c.w, c.d2);
}

/// Variation of a node's motion, world axes.
struct NodeVariation {
  Vec3 x = Vec3::Zero(),   ///< of the mass centre
      phi = Vec3::Zero(),  ///< rotation vector
      v = Vec3::Zero(),    ///< of its velocity
      w = Vec3::Zero();    ///< of the angular velocity
};

/// The variation of a node under dq and dv of its own coordinates. `p`, `own`: motions of the parent and the node.
inline NodeVariation vary(const TreeNode& n, const double* q, const double* v, const double* dq, const double* dv,
                          const Motion& p, const Motion& own, const NodeVariation& dp) {
  Motion again;
  Carried c;
  const Vec3 wp = p.A * p.w;
  carry(n, q, v, p, wp, again, c);
  const double *a = q + n.n_slides, *da = dq + n.n_slides, *dad = dv + n.n_slides;
  NodeVariation d;
  Vec3 turn = Vec3::Zero();  // d of c.turn but for the motion of its axes
  d.phi = dp.phi;
  if (n.turn == TreeTurn::hinge) {
    const Vec3 axis = p.A * n.axis;
    d.phi += axis * da[0];
    turn = axis * dad[0];
  } else if (n.turn == TreeTurn::ball) {
    const Mat3 B = (n.reversed ? p.A : own.A) * n.ball;
    const Quat r{a[0], a[1], a[2], a[3]};
    d.phi += B * (2.0 / norm2(r) * (conjugate(r) * Quat{da[0], da[1], da[2], da[3]}).vec());
    turn = B * Vec3(dad[0], dad[1], dad[2]);
  }
  const bool turns_with_child = n.turn == TreeTurn::ball && !n.reversed;
  d.w = dp.w + turn + cross(turns_with_child ? d.phi : dp.phi, c.turn);
  Vec3 rho = Vec3::Zero(), rhod = Vec3::Zero();
  for (int k = 0; k < n.n_slides; ++k)
    rho += n.slide[static_cast<std::size_t>(k)] * dq[k], rhod += n.slide[static_cast<std::size_t>(k)] * dv[k];
  const Mat3& S = n.reversed ? own.A : p.A;
  Vec3 d1 = cross(dp.phi, c.d1), d2 = cross(d.phi, c.d2);
  (n.reversed ? d2 : d1) += S * rho;
  const Vec3 slide = cross(n.reversed ? d.phi : dp.phi, c.slide) + S * rhod;
  d.x = dp.x + d1 + d2;
  d.v = dp.v + cross(dp.w, c.d1) + cross(wp, d1) + slide + cross(d.w, c.d2) + cross(c.w, d2);
  return d;
}

}  // namespace lockstep
