// SPDX-License-Identifier: BSD-3-Clause
// A coordinate of one frame relative to another, on any number type: what formulas of forces read.
#pragma once

#include <cmath>
#include <span>

#include <lockstep/author/jet.h>
#include <lockstep/author/params.h>
#include <lockstep/author/relative.h>
#include <lockstep/detail/counted_angle.h>
#include "framework/foundation/math/limits.h"
#include "framework/mechanism/params/units.h"

namespace lockstep {

/// A body's frame, a marker, or the world.
struct BodyOrMarker {
  const Body* body = nullptr;      ///< null: the world
  const Marker* marker = nullptr;  ///< null: the body's own frame
  bool center = false;             ///< origin at the centre of mass, axes of its slot
  LOCKSTEP_API MarkerFrame folded() const;
};

/// A coordinate of a frame m relative to a frame n, or its rate. a_k: an axis of n, b_k of m; d = x_m - x_n.
///
///     position    a_k.d                              rate  a_k.(v_m - v_n - w_n x d)
///     distance    |d|                                rate  d.(v_m - v_n)/|d|
///     turn        2 atan2(e_k, e0), turns counted    rate  g.(w_m - w_n),  g = (a_k + b_k)/(1 + a_k.b_k)
///     omega                                          rate  a_k.(w_m - w_n)
///     own_omega                                      rate  b_k.(w_m - w_n)
///     heading     angle of b_(k+1) about a_k from a_(k+1), turns counted
///     quaternion  component k = 0 ... 3 of e = e_n' e_m, rate of e (0, w)/2, w in m
///
/// The gradient g of the turn has no value if b_k = -a_k: the coordinate then has the direction 0. The rate of a distance
/// is 0 if the origins meet. Second rates are derivatives of rates: values on numbers that move.
class LOCKSTEP_API Coordinate {
 public:
  enum class Kind { position, distance, turn, omega, own_omega, heading, quaternion };
  struct Of {
    Kind kind = Kind::position;
    int axis = 0;
    int order = 0;  ///< of the derivative by time that its value is; angular velocities are of order 1
  };
  Coordinate(Of of, const BodyOrMarker& m, const BodyOrMarker& n) : of_(of), m_(m), n_(n) {}

  Dimension dimension() const;
  const Of& of() const { return of_; }
  const BodyOrMarker& from() const { return m_; }  ///< frame m
  const BodyOrMarker& to() const { return n_; }    ///< frame n
  /// Folds the frames into their slots; after System has made them.
  void setup() { M_ = m_.folded(), N_ = n_.folded(); }
  /// Asks for its turns, if it has some; the frames of a turn are markers.
  void count_angles(AngleCounter&);
  const CountedAngle* angle() const { return angle_; }  ///< then what counts them
  const MarkerFrame& m() const { return M_; }
  const MarkerFrame& n() const { return N_; }

  /// The coordinate, or its rate if it is of an order above 0.
  template <class T>
  T value(const MarkerOn<T>& m, const MarkerOn<T>& n, std::span<const double> s) const {
    if (of_.order == 0) return coordinate(m, n, s);
    const bool meet = of_.kind == Kind::distance && value_of(norm_of(Vec3T<T>(m.x() - n.x()))) == 0;
    return meet ? T(0) : rate(m, n, direction(m, n));
  }
  /// Derivative of the coordinate along the motion, by its direction.
  template <class T>
  T rate(const MarkerOn<T>& m, const MarkerOn<T>& n, const Vec3T<T>& direction) const {
    if (of_.kind == Kind::quaternion) {
      const Vec3T<T> w = m.A().transpose() * Vec3T<T>(m.w() - n.w());
      return 0.5 * ((conjugate(n.q()) * m.q()) * QuatT<T>{T(0), w[0], w[1], w[2]}).coefficients()[of_.axis];
    }
    if (of_.kind == Kind::heading) {
      const Vec3T<T> a = heading(m, n), w = n.A().transpose() * Vec3T<T>(m.w() - n.w()), ad = cross(w, a);  // (1.10)
      const T clear = a[i()] * a[i()] + a[j()] * a[j()];
      return value_of(clear) > kRoundOff ? T((a[i()] * ad[j()] - a[j()] * ad[i()]) / clear) : T(0);
    }
    if (turns()) return direction.dot(Vec3T<T>(m.w() - n.w()));
    const Vec3T<T> d = m.x() - n.x();
    return direction.dot(Vec3T<T>(m.v() - n.v() - cross(n.w(), d)));
  }
  /// The direction in which a force, or a torque, does work on the coordinate; world axes.
  template <class T>
  Vec3T<T> direction(const MarkerOn<T>& m, const MarkerOn<T>& n) const {
    if (of_.kind == Kind::distance) {
      const Vec3T<T> d = m.x() - n.x();
      return T(1.0 / norm_of(d)) * d;
    }
    if (of_.kind == Kind::quaternion) return Vec3T<T>::Zero();
    if (of_.kind == Kind::own_omega) return m.axis(of_.axis);
    const Vec3T<T> a = n.axis(of_.axis);
    if (of_.kind != Kind::turn) return a;
    const Vec3T<T> b = m.axis(of_.axis);
    const T sum = 1.0 + b.dot(a);
    return value_of(sum) != 0 ? Vec3T<T>(T(1.0 / sum) * (b + a)) : Vec3T<T>(Vec3T<T>::Zero());
  }

 private:
  bool turns() const { return of_.kind != Kind::position && of_.kind != Kind::distance; }
  int i() const { return (of_.axis + 1) % 3; }
  int j() const { return (of_.axis + 2) % 3; }
  template <class T>
  Vec3T<T> heading(const MarkerOn<T>& m, const MarkerOn<T>& n) const {
    return n.A().transpose() * m.axis(i());
  }
  template <class T>
  static T norm_of(const Vec3T<T>& d) {
    using std::sqrt;
    return sqrt(d.dot(d));
  }
  template <class T>
  T coordinate(const MarkerOn<T>& m, const MarkerOn<T>& n, std::span<const double> s) const {
    using std::atan2;
    const Vec3T<T> d = m.x() - n.x();
    if (of_.kind == Kind::distance) return norm_of(d);
    if (of_.kind == Kind::position) return n.axis(of_.axis).dot(d);
    const QuatT<T> e = conjugate(n.q()) * m.q();
    if (of_.kind == Kind::quaternion) return e.coefficients()[of_.axis];
    const Vec3T<T> a = of_.kind == Kind::heading ? heading(m, n) : Vec3T<T>::Zero();
    const T q = of_.kind == Kind::heading ? T(atan2(a[j()], a[i()]))
                                          : T(2.0 * atan2(of_.axis == 0   ? e.x
                                                          : of_.axis == 1 ? e.y
                                                                          : e.z,
                                                          e.w));
    return q + kTwoPi * std::round(((angle_ ? angle_->expected(s) : 0.0) - value_of(q)) / kTwoPi);
  }

  Of of_;
  BodyOrMarker m_, n_;
  MarkerFrame M_, N_;
  const CountedAngle* angle_ = nullptr;  // of a turn or heading; null: no system counts it
};

}  // namespace lockstep
