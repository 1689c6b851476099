// The lock, all of it: C, Ct, rows and right side of one marker pair (theory, (3.8)-(3.12) and (4.10)-(4.14)).
//
// Two functions, translation and rotation, so that a joint with one half never pays for the other; templates on the
// scalar (double, jet, counting number) and on the laws that are present. A law that is absent costs nothing; a row
// that is masked costs no jacobian.
#pragma once

#include "framework/mechanism/lock/mask.h"
#include "framework/foundation/math/quaternion.h"
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
/// Imposed rotation q_D(t) of frame D against S (q_sDelta of the paper); A = A(q); w, a: delta, deltad in D axes.
template <class T>
struct ImposedRotationT {
  QuatT<T> q;
  Mat3T<T> A = Mat3T<T>::Identity();
  Vec3T<T> w = Vec3T<T>::Zero(), a = Vec3T<T>::Zero();
};

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

/// Translational half. rows: bits 0..2 of a Mask say which jacobian rows are wanted.
template <unsigned kWith, class T>
inline void translation(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                        const MarkerMotionT<T>& S, const ImposedTranslationT<T>& D, Mask rows,
                        TranslationRowsT<T>& out) {
  using V = Vec3T<T>;
  constexpr bool kParallel = kWith & with::parallel;
  static_assert(!kParallel || !(kWith & with::qS), "a marker that turns is not parallel to its body");
  const T two(2);
  const auto to_S = [&](const V& b) -> V {  // A_S^T b
    if constexpr (kParallel)
      return b;
    else
      return S.A.transpose() * b;
  };

  // (3.8) s = A2^T (x1 + A1 uP - x2),  rho = A_S^T (s - uS),  C = rho - p
  const V s = O2.A.transpose() * (O1.x + O1.A * P.u - O2.x);
  const V rho = to_S(s - S.u);
  if constexpr (kWith & with::p)
    out.C = rho - D.p;
  else
    out.C = rho;

  // (3.9) rows: R^T = A_S^T A2^T | uP x (R^T A1) | -R^T | A_S^T x s
  for (int k = 0; k < 3; ++k) {
    if (!has(rows, row_bit(k))) continue;
    V Rt;
    if constexpr (kParallel)
      Rt = O2.A.col(k);
    else
      Rt = O2.A * S.A.col(k);
    out.Jv.row(k) = Rt;
    if constexpr (kWith & with::world_rows) {  // R times (3.9): 1 | -A1 uP~ | -1 | A2 s~
      out.Jw1.row(k) = cross(P.u, V(O1.A.row(k).transpose()));
      out.Jw2.row(k) = cross(V(O2.A.row(k).transpose()), s);
      continue;
    }
    if constexpr (kParallel)
      out.Jw2.row(k) = Vec3T<T>(k == 0   ? T(0)
                                : k == 1 ? s[2]
                                         : -s[1],
                                k == 1   ? T(0)
                                : k == 2 ? s[0]
                                         : -s[2],
                                k == 2   ? T(0)
                                : k == 0 ? s[1]
                                         : -s[0]);
    else
      out.Jw2.row(k) = cross(S.A.col(k), s);
    out.Jw1.row(k) = cross(P.u, V(O1.A.transpose() * Rt));
  }

  // (3.10) vP = v1 + A1 (w1 x uP + uPd),  sd = A2^T (vP - v2) - w2 x s,  rhod = A_S^T (sd - uSd) - sigma x rho
  const V w1uP = cross(O1.w, P.u), w2s = cross(O2.w, s);
  V vP;
  if constexpr (kWith & with::uP)
    vP = O1.v + O1.A * (w1uP + P.ud);
  else
    vP = O1.v + O1.A * w1uP;
  const V sd = O2.A.transpose() * (vP - O2.v) - w2s;

  // (3.12) b = w1 x (w1 x uP + 2 uPd) + uPdd,  sdd0 = A2^T A1 b - w2 x (2 sd + w2 x s)
  V b;
  if constexpr (kWith & with::uP)
    b = cross(O1.w, V(w1uP + two * P.ud)) + P.udd;
  else
    b = cross(O1.w, w1uP);
  V sdd = O2.A.transpose() * (O1.A * b) - cross(O2.w, V(two * sd + w2s));

  // rhodd0 = A_S^T (sdd0 - uSdd) - sigma x (2 rhod + sigma x rho) - sigmad x rho,  Qhat = pdd - rhodd0
  if constexpr (kWith & with::uS) sdd -= S.udd;
  V rhodd = to_S(sdd);
  V rhod, sigma_rho;
  if constexpr (kWith & (with::qS | with::rates)) {
    if constexpr (kWith & with::uS)
      rhod = to_S(sd - S.ud);
    else
      rhod = to_S(sd);
  }
  if constexpr (kWith & with::qS) {
    sigma_rho = cross(S.w, rho);
    rhod -= sigma_rho;
    rhodd -= cross(S.w, V(two * rhod + sigma_rho)) + cross(S.a, rho);
  }
  if constexpr (kWith & with::p)
    out.Qhat = D.pdd - rhodd;
  else
    out.Qhat = -rhodd;
  if constexpr (kWith & with::rates) {
    if constexpr (kWith & with::p)
      out.yd = rhod - D.pd;
    else
      out.yd = rhod;
  }

  // (3.11) Ct = R^T A1 uPd - A_S^T uSd - sigma x rho - pd
  if constexpr (kWith & (with::uP | with::uS | with::qS | with::p)) {
    if constexpr (kWith & with::uP)
      out.Ct = to_S(O2.A.transpose() * (O1.A * P.ud));
    else
      out.Ct = V::Zero();
    if constexpr (kWith & with::uS) out.Ct -= to_S(S.ud);
    if constexpr (kWith & with::qS) out.Ct -= sigma_rho;
    if constexpr (kWith & with::p) out.Ct -= D.pd;
  } else {
    out.Ct = V::Zero();
  }
}

namespace kernel_detail {
/// Row k of (h0 1 + hv~), times A: the jacobian rows (4.12), 15 operations a row.
template <class T>
inline Vec3T<T> half_row(int k, const T& h0, const Vec3T<T>& hv) {
  if (k == 0) return {h0, -hv[2], hv[1]};
  if (k == 1) return {hv[2], h0, -hv[0]};
  return {-hv[1], hv[0], h0};
}
}  // namespace kernel_detail

/// Rotational half. rows: bits 3..5 of a Mask say which jacobian rows are wanted.
template <unsigned kWith, class T>
inline void rotation(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P, const MarkerMotionT<T>& S,
                     const ImposedRotationT<T>& D, Mask rows, RotationRowsT<T>& out) {
  using V = Vec3T<T>;
  constexpr bool kParallel = kWith & with::parallel, kScalar = kWith & with::scalar_row;
  constexpr bool kQD = kWith & with::qD, kQS = kWith & with::qS, kQP = kWith & with::qP;
  static_assert(!kParallel || !(kQP || kQS), "markers that turn are not parallel to their bodies");
  const T half(0.5), quarter(0.25);

  // (4.1), (4.2) r = q_S' q_2' q_1 q_P,  e = q_D' r,  C = vec(e)
  QuatT<T> e = conjugate(O2.e) * O1.e;
  if constexpr (kQD && kParallel)
    e = conjugate(D.q) * e;
  else if constexpr (kQD)
    e = conjugate(S.q * D.q) * (e * P.q);
  else if constexpr (!kParallel)
    e = conjugate(S.q) * (e * P.q);
  const V ev = e.vec();
  out.e = e;
  out.C = ev;

  // (4.12) Jw1 = +(1/2)(e0 1 + ev~) A_P^T,  Jw2 = -(1/2)(e0 1 - ev~) A_SD^T
  const T h0 = half * e.w;
  const V hv = half * ev;
  Mat3T<T> A_SD;
  if constexpr (kQD && kParallel)
    A_SD = D.A;
  else if constexpr (kQD)
    A_SD = S.A * D.A;
  for (int k = 0; k < 3; ++k) {
    if (!has(rows, row_bit(k + 3))) continue;
    const V n1 = kernel_detail::half_row<T>(k, h0, hv), n2 = kernel_detail::half_row<T>(k, T(-h0), hv);
    if constexpr (kParallel)
      out.Jw1.row(k) = n1;
    else
      out.Jw1.row(k) = P.A * n1;
    if constexpr (kQD)
      out.Jw2.row(k) = A_SD * n2;
    else if constexpr (kParallel)
      out.Jw2.row(k) = n2;
    else
      out.Jw2.row(k) = S.A * n2;
  }
  if constexpr (kScalar) {
    if constexpr (kParallel)
      out.Jw1_0 = -hv;
    else
      out.Jw1_0 = -(P.A * hv);
    if constexpr (kQD)
      out.Jw2_0 = A_SD * hv;
    else if constexpr (kParallel)
      out.Jw2_0 = hv;
    else
      out.Jw2_0 = S.A * hv;
  }

  // (4.10) W_P = A_P^T w1 + pi,  W_S = A_S^T w2 + sigma,  W_D = A_D^T W_S + delta, and their rates with al1 = al2 = 0
  V WP = O1.w, WD = O2.w, WPd, WDd;
  if constexpr (!kParallel) WP = P.A.transpose() * O1.w, WD = S.A.transpose() * O2.w;
  if constexpr (kQP) WPd = P.a - cross(P.w, WP), WP += P.w;
  if constexpr (kQS) WDd = S.a - cross(S.w, WD), WD += S.w;
  if constexpr (kQD) {
    WD = D.A.transpose() * WD;
    if constexpr (kQS)
      WDd = D.A.transpose() * WDd + D.a - cross(D.w, WD);
    else
      WDd = D.a - cross(D.w, WD);
    WD += D.w;
  }

  // e0 a + ev x a + ev x b - e0 b: the vector part of e b' - a e with pure a, b, for (4.11), (4.13), (4.14)
  const auto turn = [&](const V& a) -> V { return e.w * a + cross(ev, a); };  // vec(e a)
  const auto back = [&](const V& a) -> V { return e.w * a - cross(ev, a); };  // vec(a e)

  // (4.14) Qhat = vec[ (1/4)(|W_P|^2 + |W_D|^2) e + (1/2) W_D e W_P - (1/2)(e W_P0d - W_D0d e) ]
  const T k = quarter * (WP.dot(WP) + WD.dot(WD));
  const V t = turn(WP);
  const T ev_WP = ev.dot(WP);
  V mid = cross(WD, t) - ev_WP * WD;
  T mid0(0);
  if constexpr (kScalar) mid0 = -WD.dot(t);
  if constexpr (kQP) {
    mid -= turn(WPd);
    if constexpr (kScalar) mid0 += ev.dot(WPd);
  }
  if constexpr (kQS || kQD) {
    mid += back(WDd);
    if constexpr (kScalar) mid0 -= ev.dot(WDd);
  }
  out.Qhat = k * ev + half * mid;
  if constexpr (kScalar) out.Qhat0 = k * e.w + half * mid0;

  // (4.11) ed = (1/2)(e W_P - W_D e)
  if constexpr (kWith & with::rates) {
    out.yd = half * (t - back(WD));
    out.yd0 = half * (ev.dot(WD) - ev_WP);
  }

  // (4.13) Ct: (4.11) with w1 = w2 = 0, W_P -> pi, W_D -> A_D^T sigma + delta
  out.Ct = V::Zero();
  out.Ct0 = T(0);
  if constexpr (kQP) {
    out.Ct = half * turn(P.w);
    if constexpr (kScalar) out.Ct0 = -half * ev.dot(P.w);
  }
  if constexpr (kQS || kQD) {
    V wD;
    if constexpr (kQS && kQD)
      wD = D.A.transpose() * S.w + D.w;
    else if constexpr (kQS)
      wD = S.w;
    else
      wD = D.w;
    out.Ct -= half * back(wD);
    if constexpr (kScalar) out.Ct0 += half * ev.dot(wD);
  }
}

}  // namespace lockstep
