// look: the seven raw coordinates of P seen from S, with all that a function of them needs (theory, (7.1)): no imposed
// law is taken off, the markers' own laws are in.
#pragma once

#include "framework/mechanism/lock/kernel.h"

namespace lockstep {

template <class T>
using Vec7T = Eigen::Matrix<T, 7, 1>;
template <class T>
using Mat73T = Eigen::Matrix<T, 7, 3>;

/// Which coordinates are wanted; the others stay unset and cost nothing.
enum class Reads { translation = 1, rotation = 2, both = 3 };

/// y = (x y z | e0 e1 e2 e3): position of P in S axes, relative quaternion r = q_S' q_2' q_1 q_P; yd, partial Ct and
/// Qhat; jacobians on v1 (world), w1, w2 (slot axes); those on v2 are minus those on v1.
template <class T>
struct LockPointT {
  Vec7T<T> y = Vec7T<T>::Zero(), yd = Vec7T<T>::Zero(), Ct = Vec7T<T>::Zero(), Qhat = Vec7T<T>::Zero();
  Mat73T<T> Jv1 = Mat73T<T>::Zero(), Jw1 = Mat73T<T>::Zero(), Jw2 = Mat73T<T>::Zero();
};
using LockPoint = LockPointT<double>;

/// Never throws. `laws`: with::Bits of the markers' own laws; zero for markers that stand still on their bodies.
template <class T>
inline LockPointT<T> look(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                          const MarkerMotionT<T>& S, unsigned laws, Reads which = Reads::both) {
  constexpr unsigned kStill = with::rates | with::scalar_row;
  constexpr unsigned kMoving = kStill | with::uP | with::qP | with::uS | with::qS;
  LockPointT<T> L;
  if (unsigned(which) & unsigned(Reads::translation)) {
    TranslationRowsT<T> r;
    if (laws)
      translation<kMoving>(O1, O2, P, S, {}, Mask::xyz, r);
    else
      translation<kStill>(O1, O2, P, S, {}, Mask::xyz, r);
    L.y.template head<3>() = r.C, L.yd.template head<3>() = r.yd;
    L.Ct.template head<3>() = r.Ct, L.Qhat.template head<3>() = r.Qhat;
    L.Jv1.template topRows<3>() = r.Jv, L.Jw1.template topRows<3>() = r.Jw1, L.Jw2.template topRows<3>() = r.Jw2;
  }
  if (unsigned(which) & unsigned(Reads::rotation)) {
    RotationRowsT<T> r;
    if (laws)
      rotation<kMoving>(O1, O2, P, S, {}, Mask::e123, r);
    else
      rotation<kStill>(O1, O2, P, S, {}, Mask::e123, r);
    L.y.template tail<4>() << r.e.w, r.C[0], r.C[1], r.C[2];
    L.yd.template tail<4>() << r.yd0, r.yd[0], r.yd[1], r.yd[2];
    L.Ct.template tail<4>() << r.Ct0, r.Ct[0], r.Ct[1], r.Ct[2];
    L.Qhat.template tail<4>() << r.Qhat0, r.Qhat[0], r.Qhat[1], r.Qhat[2];
    L.Jw1.row(3) = r.Jw1_0, L.Jw2.row(3) = r.Jw2_0;
    L.Jw1.template bottomRows<3>() = r.Jw1, L.Jw2.template bottomRows<3>() = r.Jw2;
  }
  return L;
}

}  // namespace lockstep
