// SPDX-License-Identifier: BSD-3-Clause
// JointPasses: what a joint does to the inertia, the forces and the accelerations that pass through it, one text for all
// spaces (Featherstone 2008, chapter 7).
#pragma once

#include "framework/dynamics/tree/spaces.h"

namespace lockstep::bodies {

/// A velocity coordinate: motion S of the slot per unit, U = IA S, D = S' U, u = -S' p. D is a number: the coordinates of
/// one joint are eliminated one after another, as if each had a joint of its own, the first at the slot. The inverse of
/// all of D at once would lose the small inertia of a bar about its own axis.
template <class Space>
struct alignas(kAlign<typename Space::Linear>) Coordinate {
  typename Space::Twist S;
  typename Space::Wrench U;
  typename Space::Number u, D_1;
};

/// Motions of a joint's coordinates, of which the first are translations, by its axes (`slides`, `turns`); arm: from the
/// point about which it turns to the slot's.
template <class Axes, class V3, class Space>
LOCKSTEP_INLINE void put_axes(int n_slides, int n_v, const Axes& axes, const V3& arm, Coordinate<Space>* dof) {
  for (int i = 0; i < n_slides; ++i) dof[i].S = {Space::from(axes.slides[i]), typename Space::Axial{}};
  for (int i = n_slides; i < n_v; ++i) {
    const auto& axis = axes.turns[i - n_slides];
    dof[i].S = {Space::from(V3(cross(axis, arm))), Space::from_axial(axis)};
  }
}

/// A joint of n coordinates, at a point that is r from that of the parent, where c is the acceleration beyond the parent's
/// own if the coordinates' are zero. kN: n, where the compiler knows it; else -1.
template <class Space, int kN = -1>
struct JointPasses {
  using Number = typename Space::Number;
  using Wrench = typename Space::Wrench;
  using Twist = typename Space::Twist;
  using Inertia = typename Space::Inertia;

  Coordinate<Space>* dof;
  int n;
  const typename Space::Linear& r;
  const Twist& c;

  LOCKSTEP_INLINE int n_v() const { return kN < 0 ? n : kN; }

  /// U = IA S, D = S' U, u = -S' p, then IA <- IA - U D^-1 U', p <- p + U D^-1 u. `at_root`: IA is not read afterwards.
  LOCKSTEP_INLINE void eliminate(Inertia& IA, bool at_root) const {
    for (int i = 0; i < n_v(); ++i) {
      Coordinate<Space>& d = dof[i];
      const Wrench U = IA * d.S;
      const Number u = -dot(IA.p, d.S), D_1 = 1.0 / dot(U, d.S);
      d.U = U, d.u = u, d.D_1 = D_1;
      if (i + 1 == n_v() && at_root) return;
      const Wrench V = D_1 * U;
      IA.subtract(V, U);
      IA.p += u * V;
    }
  }
  /// p <- p + IA c, then all about the parent's point.
  LOCKSTEP_INLINE void shift(Inertia& IA) const {
    IA.p += IA * c;
    IA.move(r);
  }
  /// The same of a row of closures: kappa = K S, V = kappa D^-1, K <- K - V U', l <- l + V u; then l <- l + K c, and K about
  /// the parent's point.
  template <class Numbers>
  LOCKSTEP_INLINE void pass(Wrench& K, Number& l, Number* kappa, Numbers V) const {
    for (int i = 0; i < n_v(); ++i) {
      const Coordinate<Space>& d = dof[i];
      kappa[i] = dot(K, d.S);
      const Number v = kappa[i] * d.D_1;
      V[i] = v;
      K -= v * d.U, l += v * d.u;
    }
    l += dot(K, c);
    K = about(r, K);
  }
  /// u = -S' p, p <- p + U D^-1 u, then about the parent's point.
  template <class Numbers>
  LOCKSTEP_INLINE void pass_again(Wrench& p, Numbers u) const {
    for (int i = 0; i < n_v(); ++i) {
      const Coordinate<Space>& d = dof[i];
      const Number x = -dot(p, d.S);
      u[i] = x;
      p += (d.D_1 * x) * d.U;
    }
    p = about(r, p);
  }

  /// Of the slot's point, if the coordinates' own accelerations are zero; `p`: of the parent's.
  LOCKSTEP_INLINE Twist carried(const Twist& p) const {
    Twist own = at(r, p);
    own += c;
    return own;
  }
  /// vd = D^-1 (u - U' a') - less: in reverse order of elimination. less: V' lambda of closures, null without.
  template <class Numbers>
  LOCKSTEP_INLINE Twist solve(const Twist& p, const Number* less, Numbers vd) const {
    Twist own = carried(p);
    for (int i = n_v(); i-- > 0;) move_along(i, dof[i].u, less, vd, own);
    return own;
  }
  /// The same of a correction: without accelerations that velocities, laws and forces make, with its own u.
  template <class Reads, class Numbers>
  LOCKSTEP_INLINE Twist solve_again(const Twist& p, Reads u, const Number* less, Numbers dv) const {
    Twist own = at(r, p);
    for (int i = n_v(); i-- > 0;) move_along(i, u[i], less, dv, own);
    return own;
  }
  /// The coordinates' accelerations of a joint, the first n_slides of which are translations. `beyond`: the slot's acceleration less
  /// carried(). What the joint does not let happen is lost.
  LOCKSTEP_INLINE void read_off(int n_slides, Twist beyond, double* vd) const {
    for (int i = n_v(); i-- > 0;) {
      using Linear = typename Space::Linear;
      vd[i] = i < n_slides ? dot(dof[i].S.a, beyond.a) : axial_dot<Linear>(dof[i].S.al, beyond.al);
      if (i >= n_slides) beyond -= vd[i] * dof[i].S;
    }
  }

 private:
  template <class Numbers>
  LOCKSTEP_INLINE void move_along(int i, const Number& u, const Number* less, Numbers vd, Twist& own) const {
    const Coordinate<Space>& d = dof[i];
    Number x = d.D_1 * (u - dot(d.U, own));
    if (less) x -= less[i];
    vd[i] = x;
    own += x * d.S;
  }
};

/// A hinge in the plane, about the point of its joint: S = (0, 1), which leaves neither h nor I. With s = n x r, about the
/// parent's point
///
///     M <- M - D^-1 h h',  h <- M s,  I <- s' M s,  p <- p + M c + D^-1 (u - h' c) h,  tau <- s' p
///
/// in one go, where on the right all are the old ones, written so that little waits for the division.
struct PlanarHinge {
  using Wrench = InPlane<double>::Wrench;
  using Twist = InPlane<double>::Twist;
  using Inertia = InPlane<double>::Inertia;

  /// al = u - g' a_p - gs al_p, of the slot, not against the parent.
  struct Own {
    Flat g;
    double u, gs, D_1;
  };
  Own& own;
  double sign;  ///< of its angle about the normal
  const Flat& r;
  const Twist& c;

  LOCKSTEP_INLINE int n_v() const { return 1; }
  LOCKSTEP_INLINE void eliminate(Inertia& IA, bool) const {
    const Flat s = across(r), h = IA.h, Ms = IA.M(s), p = IA.p.f + IA.M(c.a);
    const double hs = dot(h, s), u = -IA.p.t - dot(h, c.a), D_1 = 1.0 / IA.I;
    own = {D_1 * h, D_1 * u, D_1 * hs, D_1};
    IA.Mii -= D_1 * (h.i * h.i), IA.Mij -= D_1 * (h.i * h.j), IA.Mjj -= D_1 * (h.j * h.j);
    IA.h = Ms - D_1 * (hs * h);
    IA.I = dot(s, Ms) - D_1 * (hs * hs);
    IA.p = {p + D_1 * (u * h), dot(s, p) + D_1 * (u * hs)};
  }
  LOCKSTEP_INLINE void shift(Inertia&) const {}
  LOCKSTEP_INLINE void pass(Wrench& K, double& l, double* kappa, double* V) const {
    const double t = kappa[0] = K.t;
    V[0] = t * own.D_1;
    l += t * own.u + dot(K.f, c.a);
    K.t = cross(r, K.f) - t * own.gs;
    K.f -= t * own.g;
  }
  LOCKSTEP_INLINE void pass_again(Wrench& p, double* u) const {
    const double x = u[0] = -p.t;
    p.t = cross(r, p.f) + x * own.gs, p.f += x * own.g;
  }
  LOCKSTEP_INLINE Twist carried(const Twist& p) const { return {at(r, p).a + c.a, p.al + c.al}; }
  LOCKSTEP_INLINE Twist solve(const Twist& p, const double* less, double* vd) const {
    return turn(carried(p), own.u, p, less, vd);
  }
  LOCKSTEP_INLINE Twist solve_again(const Twist& p, const double* u, const double* less, double* dv) const {
    return turn(at(r, p), own.D_1 * u[0], p, less, dv);
  }
  LOCKSTEP_INLINE void read_off(int, const Twist& beyond, double* vd) const { vd[0] = sign * beyond.al; }

 private:
  LOCKSTEP_INLINE Twist turn(Twist now, double u, const Twist& p, const double* less, double* vd) const {
    const double before = now.al;
    now.al = u - dot(own.g, p.a) - own.gs * p.al;
    if (less) now.al -= less[0];
    vd[0] = sign * (now.al - before);
    return now;
  }
};

}  // namespace lockstep::bodies
