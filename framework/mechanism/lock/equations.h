// The equations of the lock, (3.8)-(3.12) and (4.1)-(4.14) of the theory: the one text of them. The rows of a link in
// space (kernel.h) and in the plane (marker_lock_plane.cpp), the relative kinematics (relative_kinematics.h), functions
// of them (relative.h), their stiffness, and the copies in lanes (tools/batch/lane_rows.h) are made of these functions.
//
// Arguments are structs of math/vec.h. Which laws there are is said by their types: an absent rate is vec::None,
// parallel axes are vec::Identity, a mechanism in its plane has Zero beside the two numbers in the plane and the one
// along its normal. Nothing of it costs anything. In which axes s, C and Qhat come out is said by the arguments too:
//
//   S axes   everything as it is
//   world    O.A = 1, and w, u of both sides in world axes; with S.A = 1 as well C and Qhat are in world axes
#pragma once

#include "framework/foundation/math/vec.h"

namespace lockstep::kernel {

/// Motion of a body: x, v of its origin in world axes; A, e its axes -> world; w in its own axes.
template <class X, class M, class E, class V, class W>
struct Body {
  X x;
  M A;
  E e;
  V v;
  W w;
};
template <class X, class M, class E, class V, class W>
Body(X, M, E, V, W) -> Body<X, M, E, V, W>;

/// A marker in its body: origin u; A, q its axes -> the body's; rates of u; w, a: its angular velocity and acceleration
/// against the body, in its own axes (pi, pid for P; sigma, sigmad for S). Marker{u, A, q} is at rest.
template <class U, class M, class Q, class Ud = vec::None, class W = vec::None>
struct Marker {
  U u;
  M A;
  Q q;
  Ud ud{}, udd{};
  W w{}, a{};
};
template <class U, class M, class Q>
Marker(U, M, Q) -> Marker<U, M, Q>;
template <class U, class M, class Q, class Ud, class W>
Marker(U, M, Q, Ud, Ud, W, W) -> Marker<U, M, Q, Ud, W>;

/// Imposed translation p(t), S axes.
template <class X>
struct Shift {
  X p, pd, pdd;
};
template <class X>
Shift(X, X, X) -> Shift<X>;
/// Imposed rotation q_D(t) of D against S; w, a (delta, deltad) in D axes.
template <class Q, class M, class W>
struct Turn {
  Q q;
  M A;
  W w, a;
};
template <class Q, class M, class W>
Turn(Q, M, W, W) -> Turn<Q, M, W>;

using NoShift = Shift<vec::None>;
using NoTurn = Turn<vec::NoTurn, vec::Identity, vec::None>;

/// A row: columns on v1 (world; those on v2 are minus these), w1 and w2 (body axes).
template <class V, class W1, class W2>
struct Row {
  V v;
  W1 w1;
  W2 w2;
};
template <class V, class W1, class W2>
Row(V, W1, W2) -> Row<V, W1, W2>;

// ---------------------------------------------------------------------------------------------------------- translation

template <class S, class R, class W>
struct Position {
  S s;          ///< O2's origin -> P, O2 axes
  R rho;        ///< S -> P, S axes
  W sigma_rho;  ///< sigma x rho
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

/// (3.9) The row of P's displacement along a direction: n in world axes, n2 in O2 axes.
///
///   n | uP x (A1^T n) | -n | n2 x s
template <class M, class U, class Arm, class N, class N2>
LOCKSTEP_INLINE auto translation_row(const M& A1, const U& uP, const Arm& s, const N& n, const N2& n2) {
  return Row{n, cross(uP, transpose_times(A1, n)), cross(n2, s)};
}

template <class W1, class W2, class S>
struct Velocity {
  W1 w1_uP;  ///< w1 x uP
  W2 w2_s;   ///< w2 x s
  S sd;
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

/// (3.12) with the bodies' own accelerations zero
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

// ------------------------------------------------------------------------------------------------------------- rotation

/// (4.1), (4.2) r = q_S' q_2' q_1 q_P,  e = q_D' r;  C = vec(e)
template <class B1, class B2, class P, class S, class D>
LOCKSTEP_INLINE auto rotation_error(const B1& O1, const B2& O2, const P& p, const S& m, const D& d) {
  return conjugate(m.q * d.q) * ((conjugate(O2.e) * O1.e) * p.q);
}

/// (4.12) The row of g.e, g a quaternion; h = e/2, A_SD = A_S A_D.
///
///   0 | A_P (h0 gv - g0 hv - hv x gv) | 0 | -A_SD (h0 gv - g0 hv + hv x gv)
template <class H, class AP, class ASD, class G>
LOCKSTEP_INLINE auto rotation_row(const H& h, const AP& A_P, const ASD& A_SD, const G& g) {
  const auto even = h.w * g.v - g.w * h.v;
  const auto odd = cross(h.v, g.v);
  return Row{vec::None{}, A_P * (even - odd), -(A_SD * (even + odd))};
}

/// W_P - W_D, W_P + W_D and the same of their rates with al1 = al2 = 0.
template <class L, class S, class Ld, class Sd>
struct AngularVelocities {
  L less;
  S sum;
  Ld less_d;
  Sd sum_d;
};
template <class L, class S, class Ld, class Sd>
AngularVelocities(L, S, Ld, Sd) -> AngularVelocities<L, S, Ld, Sd>;

/// (4.10) of P and D against the world, each in its own axes
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

/// (4.10) The angular velocity of P against S, S axes: A_S^T (A2^T A1 (w1 + A_P pi) - w2) - sigma
template <class B1, class B2, class P, class S>
LOCKSTEP_INLINE auto relative_angular_velocity(const B1& O1, const B2& O2, const P& p, const S& m) {
  return transpose_times(m.A, transpose_times(O2.A, O1.A * (O1.w + p.A * p.w)) - O2.w) - m.w;
}
/// Its row along a direction: n in world axes, n2 in O2 axes.
template <class M, class N, class N2>
LOCKSTEP_INLINE auto angular_velocity_row(const M& A1, const N& n, const N2& n2) {
  return Row{vec::None{}, transpose_times(A1, n), -n2};
}

/// (1/2) (q a - b q) by the difference and the sum of the vectors a, b.
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

/// (4.14) Qhat = -(1/2) (ed W_P - W_D ed) - (1/2) (e W_P0d - W_D0d e): (4.11) once more, which is the theory's
/// (1/4)(|W_P|^2 + |W_D|^2) e + (1/2) W_D e W_P - ... with nothing left to cancel where P turns with D.
template <class E, class Ed, class W>
LOCKSTEP_INLINE auto rotation_Qhat(const E& e, const Ed& ed, const W& w) {
  return -(turning(ed, w.less, w.sum) + turning(e, w.less_d, w.sum_d));
}

}  // namespace lockstep::kernel
