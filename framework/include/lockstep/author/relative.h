// SPDX-License-Identifier: BSD-3-Clause
// Relative kinematics of two markers.
#pragma once

#include <lockstep/body.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/detail/markers.h>

namespace lockstep {

inline MarkerMotion MarkerFrame::at(double t) const {
  MarkerMotion m;
  m.u = u0, m.q = q0, m.A = A0;
  if (translation_law) {
    const TranslationValue l = translation_law->at(t);
    m.u += A0 * l.x, m.ud = A0 * l.v, m.udd = A0 * l.a;
  }
  if (rotation_law) {
    const RotationValue l = rotation_law->at(t);
    m.q = q0 * l.q, m.A = rotation(m.q), m.w = l.w, m.a = l.a;
  }
  return m;
}

/// A marker on its slot at one instant, on any scalar. Each quantity is computed when it is asked for.
template <class T>
struct MarkerOn {
  const MotionT<T>& slot;  ///< motion of the slot; must outlive this
  MarkerMotion marker;     ///< motion of the marker on the slot

  Mat3T<T> A() const { return slot.A * marker.A; }                                        ///< marker axes -> world
  Vec3T<T> axis(int k) const { return slot.A * marker.A.col(k); }                         ///< column k of A
  Vec3T<T> x() const { return slot.x + slot.A * marker.u; }                               ///< origin, world, m
  Vec3T<T> v() const { return slot.v + slot.A * (cross(slot.w, marker.u) + marker.ud); }  ///< its velocity, m/s
  Vec3T<T> w() const { return slot.A * (slot.w + marker.A * marker.w); }  ///< angular velocity, world, rad/s
  /// Quaternion of A().
  QuatT<T> q() const { return slot.e * QuatT<T>{marker.q.w, marker.q.x, marker.q.y, marker.q.z}; }
  /// Velocity of the point of the slot that is at `at` now; both in world axes, m/s and m.
  Vec3T<T> slot_velocity(const Vec3T<T>& at) const { return slot.v + cross(slot_rate(), Vec3T<T>(at - slot.x)); }
  /// Angular velocity of the slot, world axes, rad/s.
  Vec3T<T> slot_rate() const { return slot.A * slot.w; }
};
/// A marker on its slot at these inputs, which must outlive it.
inline MarkerOn<double> marker_on(const MarkerFrame& m, const Inputs& in) { return {in.slot(m.slot), m.at(in.t)}; }

// Relative kinematics of a pair of markers: the seven coordinates of P relative to S, with everything that a function
// of them needs (theory, (7.1)). The markers' own laws are included, imposed laws are not.

/// One number for each of the seven relative coordinates.
template <class T>
using Vec7T = Eigen::Matrix<T, 7, 1>;
/// Jacobian of the seven relative coordinates on three velocities.
template <class T>
using Mat73T = Eigen::Matrix<T, 7, 3>;

/// The coordinates of P relative to S, their rates and their rows.
template <class T>
struct RelativeKinematicsT {
  Vec7T<T> y = Vec7T<T>::Zero(),      ///< x y z, S axes, m; e0 e1 e2 e3, the relative quaternion r = q_S' q_2' q_1 q_P
      yd = Vec7T<T>::Zero(),          ///< d/dt of y
      Ct = Vec7T<T>::Zero(),          ///< partial derivative of y in time: the markers' own laws
      Qhat = Vec7T<T>::Zero();        ///< right-hand side of the acceleration rows: ydd = Jh acc - Qhat
  Mat73T<T> Jv1 = Mat73T<T>::Zero(),  ///< on v1 (world); minus it on v2
      Jw1 = Mat73T<T>::Zero(),        ///< on w1 (slot axes)
      Jw2 = Mat73T<T>::Zero();        ///< on w2 (slot axes)
};
/// On doubles.
using RelativeKinematics = RelativeKinematicsT<double>;

/// The relative kinematics of P on the slot O1 and S on the slot O2; what `which` leaves out is zero. `laws`: zero if
/// both markers are at rest on their slots, otherwise with::Bits of their laws. Never throws.
template <class T>
RelativeKinematicsT<T> relative_kinematics(const MotionT<T>& O1, const MotionT<T>& O2, const MarkerMotionT<T>& P,
                                           const MarkerMotionT<T>& S, unsigned laws, Reads which = Reads::both) {
  constexpr unsigned kStill = with::rates | with::scalar_row;
  constexpr unsigned kMoving = kStill | with::uP | with::qP | with::uS | with::qS;
  RelativeKinematicsT<T> L;
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

/// On doubles: compiled once, in the library.
extern template LOCKSTEP_API RelativeKinematics relative_kinematics(const Motion&, const Motion&, const MarkerMotion&,
                                                                    const MarkerMotion&, unsigned, Reads);

// RelativePair: the relative coordinates of a pair with their rates, and the row of a function with a given gradient on
// them. The Jacobians of the coordinates themselves are never formed (theory, (7.1), (7.2)).

/// What one pair of markers contributes to the row of a function.
struct PulledRow {
  Vec3 v = Vec3::Zero(),  ///< columns on v1 (world); minus these on v2
      w1 = Vec3::Zero(),  ///< columns on w1 (slot axes)
      w2 = Vec3::Zero();  ///< columns on w2 (slot axes)
  double Ct = 0,          ///< phi_y Ct_y
      Qhat = 0;           ///< phi_y Qhat_y
};

/// Motion of a marker on its slot at time t: at(t) if kMoving, otherwise a reference to its `home`.
template <bool kMoving>
LOCKSTEP_INLINE decltype(auto) marker_motion(const MarkerFrame& m, [[maybe_unused]] double t) {
  if constexpr (kMoving)
    return m.at(t);
  else
    return (m.home);
}

/// The relative coordinates of one pair of markers at one instant, and rows of functions of them. kMoving: a law moves
/// one of the markers; without it half of the terms vanish.
template <Reads kReads, bool kMoving>
class RelativePair {
 public:
  /// Evaluates the coordinates. Refers to the motions of `in` and to P and S as long as it lives.
  RelativePair(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in)
      : O1_(in.slot(P.slot)),
        O2_(in.slot(S.slot)),
        P_(marker_motion<kMoving>(P, in.t)),
        S_(marker_motion<kMoving>(S, in.t)) {
    const auto o1 = kernel::body(O1_), o2 = kernel::body(O2_);
    const auto p = kernel::marker<kMoving, kMoving>(P_), s = kernel::marker<kMoving, kMoving>(S_);
    if constexpr (reads(kReads, Reads::translation)) {
      const kernel::NoShift none{};
      const auto at = kernel::position(o1, o2, p, s);
      const auto moving = kernel::velocity(o1, o2, p, at);
      s_ = at.s;
      put<0>(y_, at.rho), put<0>(yd_, kernel::position_rate(s, at, moving));
      put<0>(Qhat_, kernel::translation_Qhat(o1, o2, p, s, none, at, moving));
      if constexpr (kMoving) put<0>(Ct_, kernel::translation_Ct(o1, o2, p, s, none, at));
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const kernel::NoTurn none{};
      const auto r = kernel::rotation_error(o1, o2, p, s, none);
      const auto w = kernel::angular_velocities(o1, o2, p, s, none);
      const auto rd = kernel::rotation_rate(r, w);
      h_ = 0.5 * r;
      put(y_, r), put(yd_, rd), put(Qhat_, kernel::rotation_Qhat(r, rd, w));
      if constexpr (kMoving) put(Ct_, kernel::rotation_Ct(r, p, s, none));
    }
  }

  /// x y z e0 e1 e2 e3; those that kReads leaves out are not set.
  const Vec7T<double>& y() const { return y_; }
  /// d/dt of y().
  const Vec7T<double>& yd() const { return yd_; }

  /// (7.2) The row of a function whose gradient on the coordinates that are read is g: 3, 4 or 7 numbers.
  template <class G>
  PulledRow pull(const G& g) const {
    constexpr int kFirst = reads(kReads, Reads::translation) ? 0 : 3, kN = G::RowsAtCompileTime;
    PulledRow row;
    if constexpr (reads(kReads, Reads::translation)) {
      const auto n2 = vec::matrix(S_.A) * vec::Vector{g[0], g[1], g[2]};
      const auto n = vec::matrix(O2_.A) * n2;
      const auto r = kernel::translation_row(vec::matrix(O1_.A), vec::vector(P_.u), s_, n, n2);
      row.v = vec::as<Vec3>(r.v), row.w1 = vec::as<Vec3>(r.w1), row.w2 = vec::as<Vec3>(r.w2);
    }
    if constexpr (reads(kReads, Reads::rotation)) {
      const vec::Quaternion gr{g[kN - 4], vec::Vector{g[kN - 3], g[kN - 2], g[kN - 1]}};
      const auto r = kernel::rotation_row(h_, vec::matrix(P_.A), vec::matrix(S_.A), gr);
      row.w1 += vec::as<Vec3>(r.w1), row.w2 += vec::as<Vec3>(r.w2);
    }
    if constexpr (kMoving) row.Ct = g.dot(Ct_.template segment<kN>(kFirst));
    row.Qhat = g.dot(Qhat_.template segment<kN>(kFirst));
    return row;
  }

 private:
  template <int kFirst, class V>
  static void put(Vec7T<double>& y, const V& v) {
    y[kFirst] = v.x, y[kFirst + 1] = v.y, y[kFirst + 2] = v.z;
  }
  template <class W, class V>
  static void put(Vec7T<double>& y, const vec::Quaternion<W, V>& q) {
    y[3] = q.w, put<4>(y, q.v);
  }

  const Motion &O1_, &O2_;
  std::conditional_t<kMoving, MarkerMotion, const MarkerMotion&> P_, S_;
  vec::Vector<double> s_;
  vec::Quaternion<double, vec::Vector<double>> h_{};
  Vec7T<double> y_, yd_, Qhat_;
  std::conditional_t<kMoving, Vec7T<double>, vec::Zero> Ct_;
};

/// A pair of markers at rest on their bodies.
template <Reads kReads>
using StillPair = RelativePair<kReads, false>;
/// A pair of which a marker moves on its body.
template <Reads kReads>
using MovingPair = RelativePair<kReads, true>;

}  // namespace lockstep
