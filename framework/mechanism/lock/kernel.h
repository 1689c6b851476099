// The rows of one marker pair in space: C, Ct, Qhat and jacobian of the translational and of the rotational half, by
// the equations of equations.h on numbers of any kind (double, jet, complex, counting number).
//
// Two functions, translation and rotation, so that a joint with one half never pays for the other; templates on the
// scalar and on the laws that are present. A law that is absent costs nothing; a row that is masked costs no jacobian.
#pragma once

#include "framework/foundation/math/quaternion.h"
#include "framework/mechanism/lock/equations.h"
#include "framework/mechanism/lock/mask.h"
#include "framework/mechanism/model/inputs.h"

namespace lockstep {

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
