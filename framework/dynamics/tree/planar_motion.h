// SPDX-License-Identifier: BSD-3-Clause
// How a joint carries its slot in the plane: the motion of a node from that of its parent.
#pragma once

#include <cmath>

#include "framework/dynamics/tree/planar_joints.h"
#include "framework/dynamics/tree/tree_motion.h"

namespace lockstep {

/// The frame of a slot, and the slot's centre of mass.
struct PlanarFrame {
  double half_c = 1, half_s = 0,  ///< cosine and sine of half the frame's angle, both by one factor near 1
      c = 1, s = 0,               ///< and of the angle
      w = 0,                      ///< angular velocity about the normal, rad/s
      height = 0;                 ///< of the centre of mass along the normal, m
  Flat x, v;                      ///< of the centre of mass, m, m/s
};

/// What laws impose, in the frame of the slot that carries S: of the slot against its parent.
struct PlanarImposed {
  Flat p, pd, pdd;       ///< translation, m, and its rates
  double height = 0,     ///< translation along the normal, m
      angle = 0,         ///< rotation, rad
      w = 0, alpha = 0;  ///< and its rates
};

/// What a joint adds, world axes. The joint acts at a point that is fixed in the slot that does not carry the slides.
struct PlanarCarried {
  Flat d1,           ///< from the parent's centre of mass to that point, m
      d2,            ///< from there to the slot's centre of mass, m
      slide,         ///< velocity of the translations and of their laws, m/s
      pdd;           ///< acceleration of the laws, m/s^2
  double alpha = 0;  ///< angular acceleration of the laws, rad/s^2
};

/// Throws what laws_at throws.
PlanarImposed planar_laws_at(const TreeNode&, const PlanarLaw&, double t, const VecX& s);

LOCKSTEP_INLINE Flat along_slides(const PlanarNode& n, const double* x) {
  Flat sum = x[0] * n.slide[0];
  if (n.n_slides > 1) sum += x[1] * n.slide[1];
  return sum;
}

/// Half the angle by which the frame of a node is turned against its parent's, rad.
LOCKSTEP_INLINE double half_turn(const PlanarNode& n, const double* q) {
  return 0.5 * (n.turns ? n.offset + n.sign * q[n.n_slides] : n.offset);
}

/// Writes the frame of a node at its coordinates and returns what its joint adds; c, s: cosine and sine of half_turn().
LOCKSTEP_INLINE PlanarCarried carry(const PlanarNode& n, const PlanarImposed* now, double c, double s, const double* q,
                                    const double* v, const PlanarFrame& p, PlanarFrame& own) {
  PlanarCarried add;
  own.w = p.w;
  if (n.turns) own.w += n.sign * v[n.n_slides];
  if (now != nullptr) {
    const double lc = std::cos(0.5 * now->angle), ls = std::sin(0.5 * now->angle), c0 = c;
    c = lc * c - ls * s, s = lc * s + ls * c0;
    own.w += now->w, add.alpha = now->alpha;
  }
  own.half_c = p.half_c * c - p.half_s * s, own.half_s = p.half_s * c + p.half_c * s;
  own.c = own.half_c * own.half_c - own.half_s * own.half_s, own.s = 2.0 * own.half_s * own.half_c;
  const double unit = 2.0 - (own.half_c * own.half_c + own.half_s * own.half_s);
  own.c *= unit, own.s *= unit;
  own.height = p.height + n.height;
  add.d1 = turned(p.c, p.s, n.near);
  add.d2 = turned(own.c, own.s, Flat{-n.far.i, -n.far.j});
  const double cs = n.reversed ? own.c : p.c, sn = n.reversed ? own.s : p.s;
  if (n.n_slides > 0) {
    (n.reversed ? add.d2 : add.d1) += turned(cs, sn, along_slides(n, q));
    add.slide = turned(cs, sn, along_slides(n, v));
  }
  if (now != nullptr) {
    (n.reversed ? add.d2 : add.d1) += turned(cs, sn, now->p);
    add.slide += turned(cs, sn, now->pd);
    add.pdd = turned(cs, sn, now->pdd);
    own.height += now->height;
  }
  own.x = p.x + (add.d1 + add.d2);
  own.v = p.v + (p.w * across(add.d1) + add.slide + own.w * across(add.d2));
  return add;
}

/// e about axis k of the world, half the angle given.
template <int k>
LOCKSTEP_INLINE Quat about(double half_c, double half_s) {
  return {half_c, k == 0 ? half_s : 0.0, k == 1 ? half_s : 0.0, k == 2 ? half_s : 0.0};
}

/// Writes the motion of a slot whose frame is known; k: the normal.
template <int k>
LOCKSTEP_INLINE void write_motion(const PlanarFrame& f, const Posture* posture, Motion& out) {
  constexpr int i = (k + 1) % 3, j = (k + 2) % 3;
  out.x[i] = f.x.i, out.x[j] = f.x.j, out.x[k] = f.height;
  out.v[i] = f.v.i, out.v[j] = f.v.j, out.v[k] = 0.0;
  // Products of numbers of length one are of length one to round-off; along a chain that adds up: one step of Newton's.
  const double unit = 1.5 - 0.5 * (f.half_c * f.half_c + f.half_s * f.half_s);
  const Quat e = about<k>(unit * f.half_c, unit * f.half_s);
  if (posture == nullptr) {
    out.A(i, i) = f.c, out.A(i, j) = -f.s, out.A(i, k) = 0.0;
    out.A(j, i) = f.s, out.A(j, j) = f.c, out.A(j, k) = 0.0;
    out.A(k, i) = 0.0, out.A(k, j) = 0.0, out.A(k, k) = 1.0;
    out.e = e;
    out.w[i] = 0.0, out.w[j] = 0.0, out.w[k] = f.w;
    return;
  }
  for (int l = 0; l < 3; ++l) {
    const double a = posture->A(i, l), b = posture->A(j, l);
    out.A(i, l) = f.c * a - f.s * b, out.A(j, l) = f.s * a + f.c * b, out.A(k, l) = posture->A(k, l);
  }
  out.e = e * posture->e;
  out.w = f.w * posture->normal;
}

/// The inverse of write_motion().
template <int k>
LOCKSTEP_INLINE PlanarFrame read_frame(const Motion& m, const Posture* posture) {
  constexpr int i = (k + 1) % 3, j = (k + 2) % 3;
  const Quat e = posture == nullptr ? m.e : m.e * conjugate(posture->e);
  PlanarFrame f;
  f.half_c = e.w, f.half_s = e.vec()[k];
  f.c = f.half_c * f.half_c - f.half_s * f.half_s, f.s = 2.0 * f.half_s * f.half_c;
  f.w = posture == nullptr ? m.w[k] : posture->normal.dot(m.w);
  f.x = {m.x[i], m.x[j]}, f.v = {m.v[i], m.v[j]}, f.height = m.x[k];
  return f;
}

}  // namespace lockstep
