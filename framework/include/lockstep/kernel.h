// The kernel of the lock: rows of one pair of markers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <lockstep/export.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

// The equations of the lock, (3.8)-(3.12) and (4.1)-(4.14) of the theory, written once. All code that needs them calls
// these functions: the rows of a link in space (below) and in a plane (marker_lock_plane.cpp), relative kinematics
// (relative.h), geometric stiffness (phi_function.h), and batches (tools/batch/lane_rows.h).
//
// Arguments are structs of lockstep::vec (math.h). Their types show which laws are present: an absent rate is
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

/// (4.12) The row of g.e for a quaternion g; h = e/2, A_SD = A_S A_D:
///
///   0 | A_P (h0 gv - g0 hv - hv x gv) | 0 | -A_SD (h0 gv - g0 hv + hv x gv)
template <class H, class AP, class ASD, class G>
LOCKSTEP_INLINE auto rotation_row(const H& h, const AP& A_P, const ASD& A_SD, const G& g) {
  const auto even = h.w * g.v - g.w * h.v;
  const auto odd = cross(h.v, g.v);
  return Row{vec::None{}, A_P * (even - odd), -(A_SD * (even + odd))};
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

/// (4.10) Angular velocity of P relative to S, S axes, rad/s: A_S^T (A2^T A1 (w1 + A_P pi) - w2) - sigma
template <class B1, class B2, class P, class S>
LOCKSTEP_INLINE auto relative_angular_velocity(const B1& O1, const B2& O2, const P& p, const S& m) {
  return transpose_times(m.A, transpose_times(O2.A, O1.A * (O1.w + p.A * p.w)) - O2.w) - m.w;
}
/// The row of that angular velocity along a direction, which is n in world axes and n2 in O2 axes.
template <class M, class N, class N2>
LOCKSTEP_INLINE auto angular_velocity_row(const M& A1, const N& n, const N2& n2) {
  return Row{vec::None{}, transpose_times(A1, n), -n2};
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
/// form (1/4)(|W_P|^2 + |W_D|^2) e + (1/2) W_D e W_P - ..., without its cancellation where P turns with D.
template <class E, class Ed, class W>
LOCKSTEP_INLINE auto rotation_Qhat(const E& e, const Ed& ed, const W& w) {
  return -(turning(ed, w.less, w.sum) + turning(e, w.less_d, w.sum_d));
}

}  // namespace lockstep::kernel

namespace lockstep {

// Mask: which of the six coordinates a lock holds. All 64 masks are valid joints (theory, (4.23)).

/// A set of rows of a lock: x y z, translations of P in S axes, m; e1 e2 e3, the vector part of the error quaternion,
/// which is half the rotation vector for small turns.
enum class Mask : std::uint8_t {
  none = 0,   ///< no row
  x = 1,      ///< along x of S
  y = 2,      ///< along y of S
  z = 4,      ///< along z of S
  e1 = 8,     ///< about x
  e2 = 16,    ///< about y
  e3 = 32,    ///< about z
  xyz = 7,    ///< all translations
  e123 = 56,  ///< all turns
  all = 63    ///< all six
};
/// Rows of a or of b.
constexpr Mask operator|(Mask a, Mask b) { return Mask(std::uint8_t(a) | std::uint8_t(b)); }
/// Rows of both.
constexpr Mask operator&(Mask a, Mask b) { return Mask(std::uint8_t(a) & std::uint8_t(b)); }
/// Whether a has all rows of `bits`.
constexpr bool includes(Mask a, Mask bits) { return (a & bits) == bits; }
/// Whether a has at least one row of `bits`.
constexpr bool overlaps(Mask a, Mask bits) { return (a & bits) != Mask::none; }
/// The mask of row k alone; k = 0..5 for x y z e1 e2 e3.
constexpr Mask row_bit(int k) { return Mask(1u << k); }
/// Number of rows.
constexpr int count_rows(Mask a) {
  int n = 0;
  for (int k = 0; k < 6; ++k) n += includes(a, row_bit(k));
  return n;
}

/// The six coordinates of P seen from S: translations along the axes of S, m, and turns about them, rad.
enum class Axis : std::uint8_t { x, y, z, rx, ry, rz };
/// 0..5 for x y z rx ry rz.
constexpr int axis_index(Axis a) { return static_cast<int>(a); }
/// Whether the coordinate is a turn.
constexpr bool is_rotation(Axis a) { return axis_index(a) >= 3; }
/// The row that a drive on this axis adds.
constexpr Mask row_of(Axis a) { return row_bit(axis_index(a)); }

/// "x y z e1 e2" -> Mask; commas and | separate words as well. Throws ParameterError (key "mask"): a word that is not a
/// row, a row named twice.
LOCKSTEP_API Mask mask_from(std::string_view words);
/// Mask -> "x y z e1 e2"; "" for an empty mask.
LOCKSTEP_API std::string to_string(Mask);
/// "x", "rz" -> Axis; throws ParameterError (key "axis") for any other word.
LOCKSTEP_API Axis axis_from(std::string_view word);
/// Axis -> "x", "rz".
LOCKSTEP_API std::string_view to_string(Axis);
/// "x" "y" "z" "e1" "e2" "e3" for k = 0..5.
LOCKSTEP_API std::string_view row_name(int k);

// The rows of one pair of markers in space: C, Ct, Qhat and jacobian, by the equations above on numbers of any kind
// (double, jet, complex, counting number).
//
// Translation and rotation are separate functions, so that a joint with rows of one kind does not pay for the other.
// Both are templates on the laws that are present: an absent law costs nothing, and a row that is left out costs no
// jacobian.

/// Motion of a marker on its slot at one instant.
template <class T>
struct MarkerMotionT {
  Vec3T<T> u = Vec3T<T>::Zero(),      ///< origin, slot axes, m
      ud = Vec3T<T>::Zero(),          ///< its velocity on the slot, slot axes, m/s
      udd = Vec3T<T>::Zero();         ///< its acceleration, m/s^2
  Mat3T<T> A = Mat3T<T>::Identity();  ///< marker axes -> slot axes
  QuatT<T> q;                         ///< quaternion of A
  Vec3T<T> w = Vec3T<T>::Zero(),  ///< angular velocity relative to the slot, marker axes, rad/s: pi of P, sigma of S
      a = Vec3T<T>::Zero();       ///< its derivative, rad/s^2: pid of P, sigmad of S
};
/// On doubles.
using MarkerMotion = MarkerMotionT<double>;

/// Imposed translation p(t) of P, S axes (q_Delta of the paper).
template <class T>
struct ImposedTranslationT {
  Vec3T<T> p = Vec3T<T>::Zero(),  ///< m
      pd = Vec3T<T>::Zero(),      ///< m/s
      pdd = Vec3T<T>::Zero();     ///< m/s^2
};
/// On doubles.
using ImposedTranslation = ImposedTranslationT<double>;
/// Imposed rotation q_D(t) of the frame D relative to S (q_sDelta of the paper).
template <class T>
struct ImposedRotationT {
  QuatT<T> q;                         ///< D axes -> S axes
  Mat3T<T> A = Mat3T<T>::Identity();  ///< A(q)
  Vec3T<T> w = Vec3T<T>::Zero(),      ///< angular velocity delta of D relative to S, D axes, rad/s
      a = Vec3T<T>::Zero();           ///< its derivative deltad, rad/s^2
};
/// On doubles.
using ImposedRotation = ImposedRotationT<double>;

/// What an instance of the kernel is compiled for.
namespace with {
/// A set of laws and of outputs, combined by |.
enum Bits : unsigned {
  nothing = 0,       ///< no law, no extra output
  uP = 1,            ///< P slides on its body
  qP = 2,            ///< P turns on its body
  uS = 4,            ///< S slides on its body
  qS = 8,            ///< S turns on its body
  p = 16,            ///< a translation is imposed
  qD = 32,           ///< a rotation is imposed
  all_laws = 63,     ///< all six laws
  parallel = 64,     ///< the markers are at rest on their slots, with parallel axes: A_P = A_S = 1
  rates = 128,       ///< computes yd as well, d/dt of the values of the rows
  scalar_row = 256,  ///< computes the scalar component of e as well (theory, section 7)
  world_rows = 512   ///< w1 and w2 of a translational row k are those of axis k of the world, where they are simpler
};
}  // namespace with

/// Translational rows k = 0..2 for x, y, z of S. Only the jacobian rows asked for are filled; columns on v2 are minus
/// those on v1.
template <class T>
struct TranslationRowsT {
  Vec3T<T> C,   ///< residual rho - p, S axes, m
      Ct,       ///< its partial derivative in time, m/s
      Qhat,     ///< right side of the acceleration rows, m/s^2
      yd;       ///< d/dt of C, m/s; with::rates
  Mat3T<T> Jv,  ///< row k on v1 (world)
      Jw1,      ///< row k on w1 (slot axes)
      Jw2;      ///< row k on w2 (slot axes)
};
/// Rotational rows k = 0..2 for e1, e2, e3, and the scalar row of e0. Only the jacobian rows asked for are filled.
template <class T>
struct RotationRowsT {
  QuatT<T> e;      ///< error quaternion q_D' r
  Vec3T<T> C,      ///< vec(e)
      Ct,          ///< its partial derivative in time, 1/s
      Qhat,        ///< right side of the acceleration rows, 1/s^2
      yd;          ///< d/dt of C, 1/s; with::rates
  Mat3T<T> Jw1,    ///< row k on w1 (slot axes)
      Jw2;         ///< row k on w2 (slot axes)
  T Ct0{0},        ///< Ct of the scalar row; with::scalar_row
      Qhat0{0},    ///< Qhat of the scalar row; with::scalar_row
      yd0{0};      ///< d/dt of e0; with::rates
  Vec3T<T> Jw1_0,  ///< the scalar row on w1; with::scalar_row
      Jw2_0;       ///< the scalar row on w2; with::scalar_row
};

namespace kernel {

/// The motion of a slot as a Body.
template <class T>
LOCKSTEP_INLINE auto body(const MotionT<T>& O) {
  return Body{vec::vector(O.x), vec::matrix(O.A), vec::quaternion(O.e), vec::vector(O.v), vec::vector(O.w)};
}
/// The vector a where it is present, otherwise vec::None.
template <bool kPresent, class T>
LOCKSTEP_INLINE auto present(const Vec3T<T>& a) {
  if constexpr (kPresent)
    return vec::vector(a);
  else
    return vec::None{};
}
/// A marker whose origin moves on its body if kSlides, and whose axes turn if kSpins.
template <bool kSlides, bool kSpins, class T>
LOCKSTEP_INLINE auto marker(const MarkerMotionT<T>& m) {
  return Marker{vec::vector(m.u),        vec::matrix(m.A),     vec::quaternion(m.q), present<kSlides>(m.ud),
                present<kSlides>(m.udd), present<kSpins>(m.w), present<kSpins>(m.a)};
}
/// A marker for the laws kWith (with::Bits); kSlides and kSpins are the bits of the laws on the marker.
template <unsigned kWith, unsigned kSlides, unsigned kSpins, class T>
LOCKSTEP_INLINE auto marker_for(const MarkerMotionT<T>& m) {
  static_assert(!(kWith & with::parallel) || !(kWith & kSpins), "a marker that turns is not parallel to its body");
  if constexpr (kWith & with::parallel)
    return Marker{vec::vector(m.u), vec::Identity{}, vec::NoTurn{}};
  else
    return marker<(kWith & kSlides) != 0, (kWith & kSpins) != 0>(m);
}
/// The imposed translation, or NoShift where kWith has none.
template <unsigned kWith, class T>
LOCKSTEP_INLINE auto imposed(const ImposedTranslationT<T>& D) {
  if constexpr (kWith & with::p)
    return Shift{vec::vector(D.p), vec::vector(D.pd), vec::vector(D.pdd)};
  else
    return NoShift{};
}
/// The imposed rotation, or NoTurn where kWith has none.
template <unsigned kWith, class T>
LOCKSTEP_INLINE auto imposed(const ImposedRotationT<T>& D) {
  if constexpr (kWith & with::qD)
    return Turn{vec::quaternion(D.q), vec::matrix(D.A), vec::vector(D.w), vec::vector(D.a)};
  else
    return NoTurn{};
}
/// Calls f<k>() for those k = 0, 1, 2 whose row first + k is in the mask.
template <class F>
LOCKSTEP_INLINE void for_rows(Mask rows, int first, F&& f) {
  if (includes(rows, row_bit(first))) f.template operator()<0>();
  if (includes(rows, row_bit(first + 1))) f.template operator()<1>();
  if (includes(rows, row_bit(first + 2))) f.template operator()<2>();
}

}  // namespace kernel

/// The translational rows, given to take(C, Ct, Qhat, row, rate): three vectors, row(vec::Unit<k>{}) the jacobian of
/// row k, a kernel::Row, and rate() = d/dt C. What `take` does not use is not computed.
template <unsigned kWith, class T, class Take>
LOCKSTEP_INLINE void translation(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                                 const MarkerMotionT<T>& S, const ImposedTranslationT<T>& D, Take&& take) {
  const auto o1 = kernel::body(O1), o2 = kernel::body(O2);
  const auto p = kernel::marker_for<kWith, with::uP, with::nothing>(P);
  const auto s = kernel::marker_for<kWith, with::uS, with::qS>(S);
  const auto d = kernel::imposed<kWith>(D);
  const auto at = kernel::position(o1, o2, p, s);
  const auto moving = kernel::velocity(o1, o2, p, at);
  const auto row = [&](auto axis) __attribute__((always_inline)) {
    const auto n2 = s.A * axis, n = o2.A * n2;
    if constexpr (kWith & with::world_rows) {
      const auto world = kernel::translation_row(o1.A, p.u, at.s, axis, transpose_times(o2.A, axis));
      return kernel::Row{n, world.w1, world.w2};
    } else {
      return kernel::translation_row(o1.A, p.u, at.s, n, n2);
    }
  };
  take(
      at.rho - d.p, kernel::translation_Ct(o1, o2, p, s, d, at), kernel::translation_Qhat(o1, o2, p, s, d, at, moving),
      row, [&]() __attribute__((always_inline)) { return kernel::position_rate(s, at, moving) - d.pd; });
}

/// The translational rows, written into `out`; x, y, z of `rows` select the jacobian rows.
template <unsigned kWith, class T>
LOCKSTEP_INLINE void translation(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                                 const MarkerMotionT<T>& S, const ImposedTranslationT<T>& D, Mask rows,
                                 TranslationRowsT<T>& out) {
  using V = Vec3T<T>;
  const auto take = [&](const auto& C, const auto& Ct, const auto& Qhat, const auto& row, const auto& rate)
      __attribute__((always_inline)) {
    out.C = vec::as<V>(C), out.Ct = vec::as<V>(Ct), out.Qhat = vec::as<V>(Qhat);
    if constexpr (kWith & with::rates) out.yd = vec::as<V>(rate());
    kernel::for_rows(
        rows, 0, [&]<int k>() __attribute__((always_inline)) {
          const auto r = row(vec::Unit<k>{});
          out.Jv.row(k) = vec::as<V>(r.v), out.Jw1.row(k) = vec::as<V>(r.w1), out.Jw2.row(k) = vec::as<V>(r.w2);
        });
  };
  translation<kWith>(O1, O2, P, S, D, take);
}

/// The rotational rows, given to take(e, Ct, Qhat, row, rate): three quaternions, row(g) the jacobian of g.e for a
/// quaternion g, a kernel::Row, and rate() = d/dt e. Row k has the k-th imaginary unit for g, the scalar row 1.
template <unsigned kWith, class T, class Take>
LOCKSTEP_INLINE void rotation(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                              const MarkerMotionT<T>& S, const ImposedRotationT<T>& D, Take&& take) {
  const auto o1 = kernel::body(O1), o2 = kernel::body(O2);
  const auto p = kernel::marker_for<kWith, with::nothing, with::qP>(P);
  const auto s = kernel::marker_for<kWith, with::nothing, with::qS>(S);
  const auto d = kernel::imposed<kWith>(D);
  const auto e = kernel::rotation_error(o1, o2, p, s, d);
  const auto w = kernel::angular_velocities(o1, o2, p, s, d);
  const auto ed = kernel::rotation_rate(e, w);
  const auto h = 0.5 * e;
  const auto A_SD = s.A * d.A;
  take(
      e, kernel::rotation_Ct(e, p, s, d), kernel::rotation_Qhat(e, ed, w),
      [&](const auto& g) __attribute__((always_inline)) { return kernel::rotation_row(h, p.A, A_SD, g); },
      [&]() __attribute__((always_inline)) { return ed; });
}

/// The rotational rows, written into `out`; e1, e2, e3 of `rows` select the jacobian rows.
template <unsigned kWith, class T>
LOCKSTEP_INLINE void rotation(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                              const MarkerMotionT<T>& S, const ImposedRotationT<T>& D, Mask rows,
                              RotationRowsT<T>& out) {
  using V = Vec3T<T>;
  const auto take = [&](const auto& e, const auto& Ct, const auto& Qhat, const auto& row, const auto& rate)
      __attribute__((always_inline)) {
    out.e = QuatT<T>::from(e.w, vec::as<V>(e.v));
    out.C = vec::as<V>(e.v), out.Ct = vec::as<V>(Ct.v), out.Qhat = vec::as<V>(Qhat.v);
    if constexpr (kWith & with::rates) out.yd = vec::as<V>(rate().v), out.yd0 = rate().w;
    kernel::for_rows(
        rows, 3, [&]<int k>() __attribute__((always_inline)) {
          const auto r = row(vec::Quaternion{vec::Zero{}, vec::Unit<k>{}});
          out.Jw1.row(k) = vec::as<V>(r.w1), out.Jw2.row(k) = vec::as<V>(r.w2);
        });
    if constexpr (kWith & with::scalar_row) {
      const auto r = row(vec::Quaternion{vec::One{}, vec::None{}});
      out.Ct0 = vec::number<T>(Ct.w), out.Qhat0 = Qhat.w;
      out.Jw1_0 = vec::as<V>(r.w1), out.Jw2_0 = vec::as<V>(r.w2);
    }
  };
  rotation<kWith>(O1, O2, P, S, D, take);
}

}  // namespace lockstep
