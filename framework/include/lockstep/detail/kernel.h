// SPDX-License-Identifier: BSD-3-Clause
// The kernel of the lock: rows of one pair of markers.
#pragma once

#include <lockstep/author/mask.h>
#include <lockstep/detail/equations.h>
#include <lockstep/detail/markers.h>
#include <lockstep/detail/vec.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

namespace lockstep {

// The rows of one pair of markers in space: C, Ct, Qhat and Jacobian, by the equations (equations.h) on numbers of any
// kind (double, jet, complex, counting number).
//
// Translation and rotation are separate functions, so that a joint with rows of one kind does not pay for the other.
// Both are templates on the laws that are present: an absent law costs nothing, and a row that is left out costs no
// Jacobian.

/// What an instance of the kernel is compiled for.
namespace with {
/// A set of laws and of outputs, combined by |.
enum Bits : unsigned {
  nothing = 0,       ///< no law, no extra output
  uP = 1,            ///< P slides on its body
  qP = 2,            ///< P rotates on its body
  uS = 4,            ///< S slides on its body
  qS = 8,            ///< S rotates on its body
  p = 16,            ///< a translation is imposed
  qD = 32,           ///< a rotation is imposed
  all_laws = 63,     ///< all six laws
  parallel = 64,     ///< the markers are at rest on their slots, with parallel axes: A_P = A_S = 1
  rates = 128,       ///< computes yd as well, d/dt of the values of the rows
  scalar_row = 256,  ///< computes the scalar component of e as well (theory, section 7)
  world_rows = 512   ///< w1 and w2 of a translational row k are those of axis k of the world, which are simpler
};
}  // namespace with

/// Translational rows k = 0..2 for x, y, z of S. Only the Jacobian rows asked for are filled; columns on v2 are minus
/// those on v1.
template <class T>
struct TranslationRowsT {
  Vec3T<T> C,   ///< residual rho - p, S axes, m
      Ct,       ///< its partial derivative in time, m/s
      Qhat,     ///< right-hand side of the acceleration rows, m/s^2
      yd;       ///< d/dt of C, m/s; with::rates
  Mat3T<T> Jv,  ///< row k on v1 (world)
      Jw1,      ///< row k on w1 (slot axes)
      Jw2;      ///< row k on w2 (slot axes)
};
/// Rotational rows k = 0..2 for e1, e2, e3, and the scalar row of e0. Only the Jacobian rows asked for are filled.
template <class T>
struct RotationRowsT {
  QuatT<T> e;      ///< error quaternion q_D' r
  Vec3T<T> C,      ///< vec(e)
      Ct,          ///< its partial derivative in time, 1/s
      Qhat,        ///< right-hand side of the acceleration rows, 1/s^2
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
/// The vector a if it is present, otherwise vec::None.
template <bool kPresent, class T>
LOCKSTEP_INLINE auto present(const Vec3T<T>& a) {
  if constexpr (kPresent)
    return vec::vector(a);
  else
    return vec::None{};
}
/// A marker whose origin moves on its body if kSlides, and whose axes rotate if kSpins.
template <bool kSlides, bool kSpins, class T>
LOCKSTEP_INLINE auto marker(const MarkerMotionT<T>& m) {
  return Marker{vec::vector(m.u),        vec::matrix(m.A),     vec::quaternion(m.q), present<kSlides>(m.ud),
                present<kSlides>(m.udd), present<kSpins>(m.w), present<kSpins>(m.a)};
}
/// A marker at rest.
template <bool kSlides, bool kSpins, class T>
LOCKSTEP_INLINE auto marker(const MarkerAtRestT<T>& m) {
  static_assert(!kSlides && !kSpins, "a marker at rest has no rates");
  return Marker{vec::vector(m.u), vec::matrix(m.A), vec::quaternion(m.q), vec::None{},
                vec::None{},      vec::None{},      vec::None{}};
}
/// A marker for the laws kWith (with::Bits); kSlides and kSpins are the bits of the laws on the marker.
template <unsigned kWith, unsigned kSlides, unsigned kSpins, class M>
LOCKSTEP_INLINE auto marker_for(const M& m) {
  static_assert(!(kWith & with::parallel) || !(kWith & kSpins), "a marker that turns is not parallel to its body");
  if constexpr (kWith & with::parallel)
    return Marker{vec::vector(m.u), vec::Identity{}, vec::NoTurn{}};
  else
    return marker<(kWith & kSlides) != 0, (kWith & kSpins) != 0>(m);
}
/// The imposed translation, or NoShift if kWith has none.
template <unsigned kWith, class T>
LOCKSTEP_INLINE auto imposed(const ImposedTranslationT<T>& D) {
  if constexpr (kWith & with::p)
    return Shift{vec::vector(D.p), vec::vector(D.pd), vec::vector(D.pdd)};
  else
    return NoShift{};
}
/// The imposed rotation, or NoTurn if kWith has none.
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

/// The translational rows, given to take(C, Ct, Qhat, row, rate): three vectors, row(vec::Unit<k>{}) the Jacobian of
/// row k, a kernel::Row, and rate() = d/dt C. Values that `take` does not use are not computed. M: MarkerMotionT, or
/// MarkerAtRestT if kWith has no law of a marker.
template <unsigned kWith, class T, class M, class Take>
LOCKSTEP_INLINE void translation(const MotionT<T>& O1, const MotionT<T>& O2, const M& P, const M& S,
                                 const ImposedTranslationT<T>& D, Take&& take) {
  const auto o1 = kernel::body(O1), o2 = kernel::body(O2);
  const auto p = kernel::marker_for<kWith, with::uP, with::nothing>(P);
  const auto s = kernel::marker_for<kWith, with::uS, with::qS>(S);
  const auto d = kernel::imposed<kWith>(D);
  const auto at = kernel::position(o1, o2, p, s);
  const auto moving = kernel::velocity(o1, o2, p, at);
  const auto row = [&](auto axis) __attribute__((always_inline)) {
    const auto n2 = s.A * axis;
    const auto n = o2.A * n2;
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

/// The translational rows, written into `out`; x, y, z of `rows` select the Jacobian rows.
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

/// The rotational rows, given to take(e, Ct, Qhat, row, rate): three quaternions, row(g) the Jacobian of g.e for a
/// quaternion g, a kernel::Row, and rate() = d/dt e. Row k has the k-th imaginary unit for g, the scalar row 1. M: as
/// for translation().
template <unsigned kWith, class T, class M, class Take>
LOCKSTEP_INLINE void rotation(const MotionT<T>& O1, const MotionT<T>& O2, const M& P, const M& S,
                              const ImposedRotationT<T>& D, Take&& take) {
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

/// The rotational rows, written into `out`; e1, e2, e3 of `rows` select the Jacobian rows.
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
