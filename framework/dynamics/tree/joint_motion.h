// JointMotion: how a joint carries its slot: the motion of a node from that of its parent, and the variation of it. One text
// for all numbers: with the types of Eigen or of vec.h.
#pragma once

#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/number_kinds.h"

namespace lockstep {

/// What the joint of a node adds to its parent's motion, world axes. The joint acts at a point that is fixed in the slot
/// that does not carry the slides.
template <class V3>
struct Carried {
  V3 slides[3],  ///< directions of the translations
      turns[3];  ///< angular velocities against the parent per unit of the turn's velocities: three of a ball
  V3 d1,         ///< from the parent's mass centre to that point, m
      d2,        ///< from there to the slot's mass centre, m
      slide,     ///< velocity of the translations, laws included, m/s
      turn,      ///< angular velocity against the parent, rad/s: of the coordinates
      law,       ///< and of the laws; only of a node with laws
      w;         ///< angular velocity of the slot, rad/s
};

/// Variation of a node's motion, world axes.
template <class V3>
struct Variation {
  V3 x,     ///< of the mass centre
      phi,  ///< rotation vector
      v,    ///< of its velocity
      w;    ///< of the angular velocity
};

/// A joint at its coordinates q and velocities v. Joint: a node by
///
///     V3, M3, Q4                     its types
///     n_slides(), turn(), reversed() as those of the TreeNode; has_laws(): whether there are `imposed` ones
///     near_u(), far_u(), axis(), K0(), K1()        likewise; the axis with laws, if there are some
///     near_q(), far_q(), hinge()     likewise, read with laws or of a ball;  slide(i), ball(i): axis i, if there is one
///     p(), pd(), pdd(), w(), a(), q()              what laws impose (Imposed)
///     unit(q)                                      q / |q|
///
/// Numbers: an array; [i] is its number i.
template <class Joint, class Numbers>
struct JointMotion {
  using V3 = typename Joint::V3;
  using M3 = typename Joint::M3;
  using Q4 = typename Joint::Q4;

  const Joint& j;
  Numbers q, v;

  /// Orientation of the slot; c, s: cosine and sine of half the angle of a hinge, 1 and 0 of another joint.
  template <class T>
  LOCKSTEP_INLINE Q4 orientation(const T& c, const T& s, const Q4& parent) const {
    Q4 e;
    if (j.turn() == TreeTurn::ball || j.has_laws()) {
      Q4 r = j.turn() == TreeTurn::ball ? j.unit(quaternion_at<V3>(q, j.n_slides())) : quaternion(c, V3(s * j.hinge()));
      if (j.has_laws()) r = j.q() * r;
      e = parent * (j.near_q() * (j.reversed() ? conjugate(r) : r) * conjugate(j.far_q()));
    } else if (j.turn() == TreeTurn::hinge) {
      e = parent * (scaled(c, j.K0()) + scaled(s, j.K1()));
    } else {
      e = parent * j.K0();
    }
    return near_unit(e);
  }

  /// What the joint adds. A_p, A: axes of the parent and of the slot; w_p: angular velocity of the parent, world axes.
  LOCKSTEP_INLINE Carried<V3> carried(const M3& A_p, const M3& A, const V3& w_p) const {
    Carried<V3> c;
    c.d1 = A_p * j.near_u(), c.d2 = -(A * j.far_u());
    c.slide = zero_vector<V3>(), c.turn = zero_vector<V3>();
    const M3& S = j.reversed() ? A : A_p;
    if (j.n_slides() > 0 || j.has_laws()) {
      V3 rho = zero_vector<V3>();
      for (int i = 0; i < j.n_slides(); ++i) {
        c.slides[i] = S * j.slide(i);
        rho = rho + q[i] * c.slides[i], c.slide = c.slide + v[i] * c.slides[i];
      }
      if (j.has_laws()) rho = rho + S * j.p(), c.slide = c.slide + S * j.pd();
      (j.reversed() ? c.d2 : c.d1) = (j.reversed() ? c.d2 : c.d1) + rho;
    }
    if (j.turn() == TreeTurn::hinge) {
      c.turns[0] = A_p * j.axis();
      c.turn = v[j.n_slides()] * c.turns[0];
    } else if (j.turn() == TreeTurn::ball) {
      for (int i = 0; i < 3; ++i) {
        c.turns[i] = (j.reversed() ? A_p : A) * j.ball(i);
        c.turn = c.turn + v[j.n_slides() + i] * c.turns[i];
      }
    }
    c.w = w_p + c.turn;
    if (j.has_laws()) c.law = S * j.w(), c.w = c.w + c.law;
    return c;
  }
  /// Velocity of the mass centre beyond the parent's own.
  LOCKSTEP_INLINE V3 velocity(const Carried<V3>& c, const V3& w_p) const {
    return V3(cross(w_p, c.d1) + c.slide + cross(c.w, c.d2));
  }
  /// a = a_p + al_p x r + ca, al = al_p + cal, with r = d1 + d2, where the coordinates' own accelerations are zero.
  LOCKSTEP_INLINE void biases(const Carried<V3>& c, const M3& A_p, const M3& A, const V3& w_p, V3& ca, V3& cal) const {
    const M3& S = j.reversed() ? A : A_p;
    cal = cross(w_p, c.turn);
    if (j.has_laws())
      cal = cal + S * j.a() + cross(w_p, c.law) + (j.reversed() ? V3(cross(c.turn, c.law)) : V3(cross(c.law, c.turn)));
    ca = cross(w_p, V3(cross(w_p, c.d1))) + cross(c.w, V3(cross(c.w, c.d2))) + cross(cal, c.d2);
    if (j.n_slides() > 0 || j.has_laws()) ca = ca + 2.0 * cross(j.reversed() ? c.w : w_p, c.slide);
    if (j.has_laws()) ca = ca + S * j.pdd();
  }

  /// The variation under dq and dv of the joint's own coordinates; laws stay as they are. dp: that of the parent.
  LOCKSTEP_INLINE Variation<V3> vary(const M3& A_p, const M3& A, const V3& w_p, Numbers dq, Numbers dv,
                                     const Variation<V3>& dp) const {
    const Carried<V3> c = carried(A_p, A, w_p);
    const int n = j.n_slides();
    Variation<V3> d;
    d.phi = dp.phi, d.w = dp.w;
    if (j.turn() == TreeTurn::hinge) {
      d.phi = d.phi + dq[n] * c.turns[0], d.w = d.w + dv[n] * c.turns[0];
    } else if (j.turn() == TreeTurn::ball) {
      const V3 turned = turned_by(quaternion_at<V3>(q, n), quaternion_at<V3>(dq, n));
      for (int i = 0; i < 3; ++i) d.phi = d.phi + turned[i] * c.turns[i], d.w = d.w + dv[n + i] * c.turns[i];
    }
    const V3& of_slides = j.reversed() ? d.phi : dp.phi;
    d.w = d.w + cross(j.turn() == TreeTurn::ball && !j.reversed() ? d.phi : dp.phi, c.turn);
    if (j.has_laws()) d.w = d.w + cross(of_slides, c.law);
    V3 moved = zero_vector<V3>(), slid = moved;  // the slides, by dq and by dv
    for (int i = 0; i < n; ++i) moved = moved + dq[i] * c.slides[i], slid = slid + dv[i] * c.slides[i];
    V3 d1 = cross(dp.phi, c.d1), d2 = cross(d.phi, c.d2);
    (j.reversed() ? d2 : d1) = (j.reversed() ? d2 : d1) + moved;
    slid = slid + cross(of_slides, c.slide);
    d.x = dp.x + d1 + d2;
    d.v = dp.v + cross(dp.w, c.d1) + cross(w_p, d1) + slid + cross(d.w, c.d2) + cross(c.w, d2);
    return d;
  }
};

}  // namespace lockstep
