// The kernel of the lock: rows of one pair of markers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <lockstep/export.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

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

/// Relative position of P against S.
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

/// Relative velocity of P against S, and its parts.
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

namespace lockstep {

// Mask: which of the six rows of a lock are in force. All 64 combinations are joints (theory, (4.23)).


/// x y z: translations of P in S's axes; e1 e2 e3: components of the error quaternion (half turns about x y z of S).
enum class Mask : std::uint8_t {
  none = 0,
  x = 1,
  y = 2,
  z = 4,
  e1 = 8,
  e2 = 16,
  e3 = 32,
  xyz = 7,
  e123 = 56,
  all = 63
};
constexpr Mask operator|(Mask a, Mask b) { return Mask(std::uint8_t(a) | std::uint8_t(b)); }
constexpr Mask operator&(Mask a, Mask b) { return Mask(std::uint8_t(a) & std::uint8_t(b)); }
constexpr bool has(Mask a, Mask bits) { return (a & bits) == bits; }
constexpr bool any(Mask a, Mask bits) { return (a & bits) != Mask::none; }
constexpr Mask row_bit(int k) { return Mask(1u << k); }
constexpr int count(Mask a) {
  int n = 0;
  for (int k = 0; k < 6; ++k) n += has(a, row_bit(k));
  return n;
}

/// The six coordinates of P seen from S: translations along, turns about the axes of S.
enum class Axis : std::uint8_t { x, y, z, rx, ry, rz };
constexpr int index(Axis a) { return static_cast<int>(a); }
constexpr bool is_rotation(Axis a) { return index(a) >= 3; }
/// The row that a drive on this axis adds.
constexpr Mask row_of(Axis a) { return row_bit(index(a)); }

/// "x y z e1 e2" -> Mask; throws ParameterError (key "mask") naming the word that is not a row.
LOCKSTEP_API Mask mask_from(std::string_view words);
LOCKSTEP_API std::string to_string(Mask);
/// "x", "rz" -> Axis; throws ParameterError (key "axis").
LOCKSTEP_API Axis axis_from(std::string_view word);
LOCKSTEP_API std::string_view to_string(Axis);
/// "x" "y" "z" "e1" "e2" "e3" for k = 0..5.
LOCKSTEP_API std::string_view row_name(int k);


// The rows of one marker pair in space: C, Ct, Qhat and jacobian of the translational and of the rotational half, by
// the equations of equations.h on numbers of any kind (double, jet, complex, counting number).
//
// Two functions, translation and rotation, so that a joint with one half never pays for the other; templates on the
// scalar and on the laws that are present. A law that is absent costs nothing; a row that is masked costs no jacobian.


/// Marker in its slot at one instant: origin u (slot axes) with rates; A, q marker axes -> slot axes; w, a: angular
/// velocity and acceleration of the marker against the slot, in marker axes (pi, pid for P; sigma, sigmad for S).
template <class T>
struct MarkerMotionT {
  Vec3T<T> u = Vec3T<T>::Zero(), ud = Vec3T<T>::Zero(), udd = Vec3T<T>::Zero();
  Mat3T<T> A = Mat3T<T>::Identity();
  QuatT<T> q;
  Vec3T<T> w = Vec3T<T>::Zero(), a = Vec3T<T>::Zero();
};
using MarkerMotion = MarkerMotionT<double>;

/// Imposed translation p(t), S axes (q_Delta of the paper).
template <class T>
struct ImposedTranslationT {
  Vec3T<T> p = Vec3T<T>::Zero(), pd = Vec3T<T>::Zero(), pdd = Vec3T<T>::Zero();
};
using ImposedTranslation = ImposedTranslationT<double>;
/// Imposed rotation q_D(t) of frame D against S (q_sDelta of the paper); A = A(q); w, a: delta, deltad in D axes.
template <class T>
struct ImposedRotationT {
  QuatT<T> q;
  Mat3T<T> A = Mat3T<T>::Identity();
  Vec3T<T> w = Vec3T<T>::Zero(), a = Vec3T<T>::Zero();
};
using ImposedRotation = ImposedRotationT<double>;

/// What the kernel is compiled for. Laws that are present; `parallel`: none on the markers and A_P = A_S = 1; `rates`:
/// yd = d/dt of the rows' values as well; `scalar_row`: the fourth component of e too (section 7 of the theory);
/// `world_rows`: the angular jacobians of a full translational triple turned into world axes by R, where they are
/// simpler.
namespace with {
enum Bits : unsigned {
  nothing = 0,
  uP = 1,
  qP = 2,
  uS = 4,
  qS = 8,
  p = 16,
  qD = 32,
  all_laws = 63,
  parallel = 64,
  rates = 128,
  scalar_row = 256,
  world_rows = 512
};
}  // namespace with

/// Translational rows k = 0..2 (only those asked for are filled in the jacobians). Columns of v2 are minus those of v1.
template <class T>
struct TranslationRowsT {
  Vec3T<T> C, Ct, Qhat, yd;
  Mat3T<T> Jv, Jw1, Jw2;  ///< row k is row k; Jv: v1 (world), Jw: w in slot axes
};
/// Rotational rows; index 0 of the scalars and of J..0 is the scalar row.
template <class T>
struct RotationRowsT {
  QuatT<T> e;
  Vec3T<T> C, Ct, Qhat, yd;
  Mat3T<T> Jw1, Jw2;
  T Ct0{0}, Qhat0{0}, yd0{0};
  Vec3T<T> Jw1_0, Jw2_0;
};

namespace kernel {

/// What the equations take, from Eigen's types.
template <class T>
LOCKSTEP_INLINE auto body(const MotionT<T>& O) {
  return Body{vec::vector(O.x), vec::matrix(O.A), vec::quaternion(O.e), vec::vector(O.v), vec::vector(O.w)};
}
template <bool kPresent, class T>
LOCKSTEP_INLINE auto present(const Vec3T<T>& a) {
  if constexpr (kPresent)
    return vec::vector(a);
  else
    return vec::None{};
}
/// Whether the marker's origin and its axes move on their body.
template <bool kSlides, bool kSpins, class T>
LOCKSTEP_INLINE auto marker(const MarkerMotionT<T>& m) {
  return Marker{vec::vector(m.u),        vec::matrix(m.A),     vec::quaternion(m.q), present<kSlides>(m.ud),
                present<kSlides>(m.udd), present<kSpins>(m.w), present<kSpins>(m.a)};
}
/// A marker for the laws of kWith, of which kSlides and kSpins are its own.
template <unsigned kWith, unsigned kSlides, unsigned kSpins, class T>
LOCKSTEP_INLINE auto marker_for(const MarkerMotionT<T>& m) {
  static_assert(!(kWith & with::parallel) || !(kWith & kSpins), "a marker that turns is not parallel to its body");
  if constexpr (kWith & with::parallel)
    return Marker{vec::vector(m.u), vec::Identity{}, vec::NoTurn{}};
  else
    return marker<(kWith & kSlides) != 0, (kWith & kSpins) != 0>(m);
}
template <unsigned kWith, class T>
LOCKSTEP_INLINE auto imposed(const ImposedTranslationT<T>& D) {
  if constexpr (kWith & with::p)
    return Shift{vec::vector(D.p), vec::vector(D.pd), vec::vector(D.pdd)};
  else
    return NoShift{};
}
template <unsigned kWith, class T>
LOCKSTEP_INLINE auto imposed(const ImposedRotationT<T>& D) {
  if constexpr (kWith & with::qD)
    return Turn{vec::quaternion(D.q), vec::matrix(D.A), vec::vector(D.w), vec::vector(D.a)};
  else
    return NoTurn{};
}
/// f<k>() for the axes k = 0, 1, 2 whose bit is in the mask.
template <class F>
LOCKSTEP_INLINE void for_rows(Mask rows, int first, F&& f) {
  if (has(rows, row_bit(first))) f.template operator()<0>();
  if (has(rows, row_bit(first + 1))) f.template operator()<1>();
  if (has(rows, row_bit(first + 2))) f.template operator()<2>();
}

}  // namespace kernel

/// Translational half: take(C, Ct, Qhat, row, rate), row(k) the jacobian of row k, an Axis<k>, rate() = d/dt C.
/// What `take` does not ask for is not computed.
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

/// The same on matrices; rows: bits 0..2 of a Mask say which jacobian rows are wanted.
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

/// Rotational half: take(C, Ct, Qhat, row, rate), all but the rows quaternions of which C = e; row(g) the jacobian of
/// g.e, g a quaternion (for row k its k-th unit vector).
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

/// The same on matrices; rows: bits 3..5 of a Mask say which jacobian rows are wanted.
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
