// SPDX-License-Identifier: BSD-3-Clause
// JointMotion: how a joint carries its slot: the motion of a node from that of its parent, and the variation of it. One text
// for all numbers and for space and plane: with the types of Eigen, or of vec.h, whose components may be absent.
#pragma once

#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/number_kinds.h"

namespace lockstep {

/// What the joint of a node adds to its parent's motion, world axes. The joint acts at a point that is fixed in the slot
/// that does not carry the slides.
template <class L, class W = L>
struct Carried {
  L slides[3],  ///< directions of the translations
      d1,       ///< from the parent's centre of mass to that point, m
      d2,       ///< from there to the slot's centre of mass, m
      slide;    ///< velocity of the translations, laws included, m/s
  W turns[3],   ///< angular velocities against the parent per unit of the turn's velocities: three of a ball
      turn,     ///< angular velocity against the parent, rad/s: of the coordinates
      law,      ///< and of the laws; only of a node with laws
      w;        ///< angular velocity of the slot, rad/s
};

/// Variation of a node's motion, world axes.
template <class L, class W = L>
struct Variation {
  L x;    ///< of the centre of mass
  W phi;  ///< rotation vector
  L v;    ///< of its velocity
  W w;    ///< of the angular velocity
};

/// A joint at its coordinates q and velocities v. Joint: a node by
///
///     L, W, M3, Q4                   its types: vectors, axial ones, matrices, quaternions
///     kBalls                         whether it may be a ball
///     n_slides(), turn(), reversed() as those of the TreeNode; has_laws(): whether there are `imposed` ones
///     near_u(), far_u(), axis(), K0(), K1()        likewise; the axis with laws, if there are some
///     near_q(), far_q(), hinge()     likewise, read with laws or of a ball;  slide(i), ball(i): axis i, if there is one
///     p(), pd(), pdd(), w(), a(), q()              what laws impose (Imposed)
///     unit(q)                                      q / |q|
///
/// Numbers: an array; [i] is its number i.
template <class Joint, class Numbers>
struct JointMotion {
  using L = typename Joint::L;
  using W = typename Joint::W;
  using M3 = typename Joint::M3;
  using Q4 = typename Joint::Q4;

  const Joint& j;
  Numbers q, v;

  /// Orientation of the slot; c, s: cosine and sine of half the angle of a hinge, 1 and 0 of another joint.
  template <class T>
  LOCKSTEP_INLINE Q4 orientation(const T& c, const T& s, const Q4& parent) const {
    Q4 e;
    if (is_ball() || j.has_laws()) {
      Q4 r = quaternion(c, W(s * j.hinge()));
      if constexpr (Joint::kBalls)
        if (is_ball()) r = j.unit(quaternion_at<W>(q, j.n_slides()));
      if (j.has_laws()) r = j.q() * r;
      e = parent * (j.near_q() * (j.reversed() ? conjugate(r) : r) * conjugate(j.far_q()));
    } else if (j.turn() == TreeTurn::hinge) {
      e = parent * (scaled(c, j.K0()) + scaled(s, j.K1()));
    } else {
      e = parent * j.K0();
    }
    return near_unit(e);
  }

  LOCKSTEP_INLINE bool is_ball() const { return Joint::kBalls && j.turn() == TreeTurn::ball; }

  /// What the joint adds. A_p, A: axes of the parent and of the slot; w_p: angular velocity of the parent, world axes.
  LOCKSTEP_INLINE Carried<L, W> carried(const M3& A_p, const M3& A, const W& w_p) const {
    Carried<L, W> c;
    c.d1 = A_p * j.near_u(), c.d2 = -(A * j.far_u());
    c.slide = zero_vector<L>(), c.turn = zero_vector<W>();
    const M3& S = j.reversed() ? A : A_p;
    if (j.n_slides() > 0 || j.has_laws()) {
      L rho = zero_vector<L>();
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
    } else if (is_ball()) {
      for (int i = 0; i < 3; ++i) {
        c.turns[i] = (j.reversed() ? A_p : A) * j.ball(i);
        c.turn = c.turn + v[j.n_slides() + i] * c.turns[i];
      }
    }
    c.w = w_p + c.turn;
    if (j.has_laws()) c.law = S * j.w(), c.w = c.w + c.law;
    return c;
  }
  /// Velocity of the centre of mass beyond the parent's own.
  LOCKSTEP_INLINE L velocity(const Carried<L, W>& c, const W& w_p) const {
    return L(cross(w_p, c.d1) + c.slide + cross(c.w, c.d2));
  }
  /// a = a_p + al_p x r + ca, al = al_p + cal, with r = d1 + d2, where the coordinates' own accelerations are zero.
  LOCKSTEP_INLINE void biases(const Carried<L, W>& c, const M3& A_p, const M3& A, const W& w_p, L& ca, W& cal) const {
    const M3& S = j.reversed() ? A : A_p;
    cal = to<W>(cross(w_p, c.turn));
    if (j.has_laws())
      cal = cal + S * j.a() + cross(w_p, c.law) +
            (j.reversed() ? to<W>(cross(c.turn, c.law)) : to<W>(cross(c.law, c.turn)));
    ca = cross(w_p, L(cross(w_p, c.d1))) + cross(c.w, L(cross(c.w, c.d2))) + cross(cal, c.d2);
    if (j.n_slides() > 0 || j.has_laws()) ca = ca + 2.0 * cross(j.reversed() ? c.w : w_p, c.slide);
    if (j.has_laws()) ca = ca + S * j.pdd();
  }

  /// The variation under dq and dv of the joint's own coordinates; laws stay as they are. dp: that of the parent.
  LOCKSTEP_INLINE Variation<L, W> vary(const M3& A_p, const M3& A, const W& w_p, Numbers dq, Numbers dv,
                                       const Variation<L, W>& dp) const {
    const Carried<L, W> c = carried(A_p, A, w_p);
    const int n = j.n_slides();
    Variation<L, W> d;
    d.phi = dp.phi, d.w = dp.w;
    if (j.turn() == TreeTurn::hinge) {
      d.phi = d.phi + dq[n] * c.turns[0], d.w = d.w + dv[n] * c.turns[0];
    }
    if constexpr (Joint::kBalls) {
      if (is_ball()) {
        const W turned = turned_by(quaternion_at<W>(q, n), quaternion_at<W>(dq, n));
        for (int i = 0; i < 3; ++i) d.phi = d.phi + turned[i] * c.turns[i], d.w = d.w + dv[n + i] * c.turns[i];
      }
    }
    const W& of_slides = j.reversed() ? d.phi : dp.phi;
    d.w = d.w + cross(is_ball() && !j.reversed() ? d.phi : dp.phi, c.turn);
    if (j.has_laws()) d.w = d.w + cross(of_slides, c.law);
    L moved = zero_vector<L>(), slid = moved;  // the slides, by dq and by dv
    for (int i = 0; i < n; ++i) moved = moved + dq[i] * c.slides[i], slid = slid + dv[i] * c.slides[i];
    L d1 = cross(dp.phi, c.d1), d2 = cross(d.phi, c.d2);
    (j.reversed() ? d2 : d1) = (j.reversed() ? d2 : d1) + moved;
    slid = slid + cross(of_slides, c.slide);
    d.x = dp.x + d1 + d2;
    d.v = dp.v + cross(dp.w, c.d1) + cross(w_p, d1) + slid + cross(d.w, c.d2) + cross(c.w, d2);
    return d;
  }
};

}  // namespace lockstep
