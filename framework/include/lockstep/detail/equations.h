// SPDX-License-Identifier: BSD-3-Clause
// The equations of the lock on numbers of any kind.
#pragma once

#include <lockstep/detail/vec.h>

// The equations of the lock, (3.8)-(3.12) and (4.1)-(4.14) of the theory, written once. All code that needs them calls
// these functions: the rows of a joint in space (kernel.h) and in a plane (marker_lock_plane.cpp), relative kinematics
// (relative.h), geometric stiffness (lock/stiffness.h), and numbers of any type (dynamics/tree/number_rows.h).
//
// Arguments are structs of lockstep::vec (vec.h). Their types show which laws are present: an absent rate is
// vec::None, parallel axes are vec::Identity, and in a planar mechanism the components that vanish are vec::Zero. What
// is known from the type costs nothing. The axes of s, C and Qhat follow from the arguments:
//
//   arguments as declared below                           s in O2 axes, C and Qhat in S axes
//   O.A = 1, and w, u of both sides in world axes         s in world axes; with S.A = 1 C and Qhat too
namespace lockstep::kernel {

/// Motion of a body.
template <class X, class M, class E, class V, class W>
struct Body {
  X x;  ///< origin, world axes, m
  M A;  ///< body axes -> world
  E e;  ///< quaternion of A
  V v;  ///< velocity of the origin, world axes, m/s
  W w;  ///< angular velocity, body axes, rad/s
};
template <class X, class M, class E, class V, class W>
Body(X, M, E, V, W) -> Body<X, M, E, V, W>;

/// A marker on its body. Marker{u, A, q} is at rest there.
template <class U, class M, class Q, class Ud = vec::None, class W = vec::None>
struct Marker {
  U u;        ///< origin, body axes, m
  M A;        ///< marker axes -> body axes
  Q q;        ///< quaternion of A
  Ud ud{},    ///< velocity of the origin on the body, body axes, m/s
      udd{};  ///< its acceleration, m/s^2
  W w{},      ///< angular velocity relative to the body, marker axes, rad/s: pi of P, sigma of S
      a{};    ///< its derivative, rad/s^2: pid of P, sigmad of S
};
template <class U, class M, class Q>
Marker(U, M, Q) -> Marker<U, M, Q>;
template <class U, class M, class Q, class Ud, class W>
Marker(U, M, Q, Ud, Ud, W, W) -> Marker<U, M, Q, Ud, W>;

/// Imposed translation p(t), S axes.
template <class X>
struct Shift {
  X p,      ///< m
      pd,   ///< m/s
      pdd;  ///< m/s^2
};
template <class X>
Shift(X, X, X) -> Shift<X>;
/// Imposed rotation q_D(t) of the frame D relative to S.
template <class Q, class M, class W>
struct Turn {
  Q q;    ///< D axes -> S axes
  M A;    ///< A(q)
  W w,    ///< angular velocity delta of D relative to S, D axes, rad/s
      a;  ///< its derivative deltad, rad/s^2
};
template <class Q, class M, class W>
Turn(Q, M, W, W) -> Turn<Q, M, W>;

/// No imposed translation.
using NoShift = Shift<vec::None>;
/// No imposed rotation: D is S.
using NoTurn = Turn<vec::NoTurn, vec::Identity, vec::None>;

/// Jacobian of one row.
template <class V, class W1, class W2>
struct Row {
  V v;    ///< columns on v1, world axes; those on v2 are minus these
  W1 w1;  ///< columns on w1, O1 axes
  W2 w2;  ///< columns on w2, O2 axes
};
template <class V, class W1, class W2>
Row(V, W1, W2) -> Row<V, W1, W2>;

// --------------------------------------------------------------------------------------------------------- translation

/// Position of P relative to S.
template <class S, class R, class W>
struct Position {
  S s;          ///< from the origin of O2 to P, O2 axes, m
  R rho;        ///< from S to P, S axes, m
  W sigma_rho;  ///< sigma x rho, S axes, m/s
};
template <class S, class R, class W>
Position(S, R, W) -> Position<S, R, W>;

/// (3.8) s = A2^T (x1 + A1 uP - x2)
template <class B1, class B2, class U>
LOCKSTEP_INLINE auto arm(const B1& O1, const B2& O2, const U& uP) {
  return transpose_times(O2.A, O1.x + O1.A * uP - O2.x);
}
/// (3.8) rho = A_S^T (s - uS);  C = rho - p
template <class B1, class B2, class P, class S>
LOCKSTEP_INLINE auto position(const B1& O1, const B2& O2, const P& p, const S& m) {
  const auto s = arm(O1, O2, p.u);
  const auto rho = transpose_times(m.A, s - m.u);
  return Position{s, rho, cross(m.w, rho)};
}

/// (3.9) The row of the displacement of P along a direction, which is n in world axes and n2 in O2 axes:
///
///   n | uP x (A1^T n) | -n | n2 x s
template <class M, class U, class Arm, class N, class N2>
LOCKSTEP_INLINE auto translation_row(const M& A1, const U& uP, const Arm& s, const N& n, const N2& n2) {
  return Row{n, cross(uP, transpose_times(A1, n)), cross(n2, s)};
}

/// Velocity of P as seen from O2, and two products that Qhat needs again.
template <class W1, class W2, class S>
struct Velocity {
  W1 w1_uP;  ///< w1 x uP, O1 axes, m/s
  W2 w2_s;   ///< w2 x s, O2 axes, m/s
  S sd;      ///< d/dt of s, O2 axes, m/s
};
template <class W1, class W2, class S>
Velocity(W1, W2, S) -> Velocity<W1, W2, S>;

/// (3.10) vP = v1 + A1 (w1 x uP + uPd),  sd = A2^T (vP - v2) - w2 x s
template <class B1, class B2, class P, class X>
LOCKSTEP_INLINE auto velocity(const B1& O1, const B2& O2, const P& p, const X& at) {
  const auto w1_uP = cross(O1.w, p.u);
  const auto w2_s = cross(O2.w, at.s);
  return Velocity{w1_uP, w2_s, transpose_times(O2.A, O1.v + O1.A * (w1_uP + p.ud) - O2.v) - w2_s};
}

/// (3.10) rhod = A_S^T (sd - uSd) - sigma x rho;  Cd = rhod - pd
template <class S, class X, class V>
LOCKSTEP_INLINE auto position_rate(const S& m, const X& at, const V& moving) {
  return transpose_times(m.A, moving.sd - m.ud) - at.sigma_rho;
}

/// (3.11) Ct = R^T A1 uPd - A_S^T uSd - sigma x rho - pd
template <class B1, class B2, class P, class S, class D, class X>
LOCKSTEP_INLINE auto translation_Ct(const B1& O1, const B2& O2, const P& p, const S& m, const D& d, const X& at) {
  return transpose_times(m.A, transpose_times(O2.A, O1.A * p.ud) - m.ud) - at.sigma_rho - d.pd;
}

/// (3.12), the bodies' own accelerations being zero:
///
///   b      = w1 x (w1 x uP + 2 uPd) + uPdd
///   sdd0   = A2^T A1 b - w2 x (2 sd + w2 x s)
///   rhodd0 = A_S^T (sdd0 - uSdd) - sigma x (2 rhod + sigma x rho) - sigmad x rho
///   Qhat   = pdd - rhodd0
template <class B1, class B2, class P, class S, class D, class X, class V>
LOCKSTEP_INLINE auto translation_Qhat(const B1& O1, const B2& O2, const P& p, const S& m, const D& d, const X& at,
                                      const V& moving) {
  const auto b = cross(O1.w, moving.w1_uP + 2.0 * p.ud) + p.udd;
  const auto sdd = transpose_times(O2.A, O1.A * b) - cross(O2.w, 2.0 * moving.sd + moving.w2_s);
  const auto seen = transpose_times(m.A, sdd - m.udd);
  if constexpr (std::is_same_v<decltype(at.sigma_rho), vec::None>) {
    return d.pdd - seen;
  } else {
    const auto rhod = position_rate(m, at, moving);
    return d.pdd - (seen - (cross(m.w, 2.0 * rhod + at.sigma_rho) + cross(m.a, at.rho)));
  }
}

// ------------------------------------------------------------------------------------------------------------ rotation

/// (4.1), (4.2) r = q_S' q_2' q_1 q_P,  e = q_D' r;  C = vec(e)
template <class B1, class B2, class P, class S, class D>
LOCKSTEP_INLINE auto rotation_error(const B1& O1, const B2& O2, const P& p, const S& m, const D& d) {
  return conjugate(m.q * d.q) * ((conjugate(O2.e) * O1.e) * p.q);
}

/// (4.12) The row of g.e for a quaternion g, on the angular velocities of P and of D, each in its own axes; h = e/2:
///
///   0 | h0 gv - g0 hv - hv x gv | 0 | -(h0 gv - g0 hv + hv x gv)
template <class H, class G>
LOCKSTEP_INLINE auto rotation_row(const H& h, const G& g) {
  const auto even = h.w * g.v - g.w * h.v;
  const auto odd = cross(h.v, g.v);
  return Row{vec::None{}, even - odd, -(even + odd)};
}
/// (4.12) A row on the angular velocities of P and D as the row on those of O1 and O2, A_SD = A_S A_D:
///
///   0 | A_P w1 | 0 | A_SD w2
template <class R, class AP, class ASD>
LOCKSTEP_INLINE auto in_body_axes(const R& row, const AP& A_P, const ASD& A_SD) {
  return Row{row.v, A_P * row.w1, A_SD * row.w2};
}
/// (4.12) The row of g.e on the angular velocities of O1 and O2, each in its own axes.
template <class H, class AP, class ASD, class G>
LOCKSTEP_INLINE auto rotation_row(const H& h, const AP& A_P, const ASD& A_SD, const G& g) {
  return in_body_axes(rotation_row(h, g), A_P, A_SD);
}

/// Difference and sum of the angular velocities of P and D, each in its own axes, rad/s, and of their rates.
template <class L, class S, class Ld, class Sd>
struct AngularVelocities {
  L less;     ///< W_P - W_D
  S sum;      ///< W_P + W_D
  Ld less_d;  ///< W_P0d - W_D0d: with al1 = al2 = 0
  Sd sum_d;   ///< W_P0d + W_D0d
};
template <class L, class S, class Ld, class Sd>
AngularVelocities(L, S, Ld, Sd) -> AngularVelocities<L, S, Ld, Sd>;

/// (4.10) Angular velocities of P and D relative to the world, each in its own axes:
///
///   W_P = A_P^T w1 + pi      W_P0d = pid - pi x (A_P^T w1)
///   W_S = A_S^T w2 + sigma   W_S0d = sigmad - sigma x (A_S^T w2)
///   W_D = A_D^T W_S + delta  W_D0d = A_D^T W_S0d + deltad - delta x (A_D^T W_S)
template <class B1, class B2, class P, class S, class D>
LOCKSTEP_INLINE auto angular_velocities(const B1& O1, const B2& O2, const P& p, const S& m, const D& d) {
  const auto w1 = transpose_times(p.A, O1.w);
  const auto w2 = transpose_times(m.A, O2.w);
  const auto wS = transpose_times(d.A, w2 + m.w);
  const auto WP = w1 + p.w;
  const auto WD = wS + d.w;
  const auto WPd = p.a - cross(p.w, w1);
  const auto WDd = transpose_times(d.A, m.a - cross(m.w, w2)) + (d.a - cross(d.w, wS));
  return AngularVelocities{WP - WD, WP + WD, WPd - WDd, WPd + WDd};
}

/// (1/2) (q a - b q) for vectors a and b: less = a - b, sum = a + b.
template <class Q, class L, class S>
LOCKSTEP_INLINE auto turning(const Q& q, const L& less, const S& sum) {
  return vec::Quaternion{-0.5 * dot(q.v, less), 0.5 * (q.w * less + cross(q.v, sum))};
}

/// (4.11) ed = (1/2) (e W_P - W_D e)
template <class E, class W>
LOCKSTEP_INLINE auto rotation_rate(const E& e, const W& w) {
  return turning(e, w.less, w.sum);
}

/// (4.13) Ct: (4.11) with w1 = w2 = 0: W_P -> pi, W_D -> A_D^T sigma + delta
template <class E, class P, class S, class D>
LOCKSTEP_INLINE auto rotation_Ct(const E& e, const P& p, const S& m, const D& d) {
  const auto w = transpose_times(d.A, m.w) + d.w;
  return turning(e, p.w - w, p.w + w);
}

/// (4.14) Qhat = -(1/2) (ed W_P - W_D ed) - (1/2) (e W_P0d - W_D0d e), which is (4.11) applied twice. It equals the
/// form (1/4)(|W_P|^2 + |W_D|^2) e + (1/2) W_D e W_P - ..., without its cancellation if P rotates with D.
template <class E, class Ed, class W>
LOCKSTEP_INLINE auto rotation_Qhat(const E& e, const Ed& ed, const W& w) {
  return -(turning(ed, w.less, w.sum) + turning(e, w.less_d, w.sum_d));
}

}  // namespace lockstep::kernel
