// SPDX-License-Identifier: BSD-3-Clause
// A coordinate of one frame relative to another, on any number type: what formulas of forces read.
#pragma once

#include <cmath>
#include <span>
#include <string>

#include <lockstep/author/params.h>
#include <lockstep/author/relative.h>
#include <lockstep/detail/counted_angle.h>
#include "framework/mechanism/params/units.h"

namespace lockstep {

/// A body's frame, a marker, or the world.
struct BodyOrMarker {
  const Body* body = nullptr;      ///< null: the world
  const Marker* marker = nullptr;  ///< null: the body's own frame
  LOCKSTEP_API MarkerFrame folded() const;
};

/// A coordinate of a frame m relative to a frame n, or its rate. a_k: an axis of n; d = x_m - x_n.
///
///     position    a_k.d                              rate  a_k.(v_m - v_n - w_n x d)
///     distance    |d|                                rate  d.(v_m - v_n)/|d|
///     turn        2 atan2(e_k, e0), turns counted    rate  g.(w_m - w_n),  g = (a_m + a_n)/(1 + a_m.a_n)
///     omega       a_k.(w_m - w_n)
///
/// The gradient g of the turn has no value if a_m = -a_n: the coordinate then has the direction 0.
class LOCKSTEP_API Coordinate {
 public:
  enum class Kind { position, distance, turn, omega };
  struct Of {
    Kind kind = Kind::position;
    int axis = 0;
    bool rate = false;  ///< whether its value is the rate
  };
  Coordinate(Of of, BodyOrMarker m, BodyOrMarker n) : of_(of), m_(m), n_(n) {}

  Dimension dimension() const;
  const Of& of() const { return of_; }
  const BodyOrMarker& from() const { return m_; }  ///< frame m
  const BodyOrMarker& to() const { return n_; }    ///< frame n
  /// Folds the frames into their slots; after System has made them.
  void setup() { M_ = m_.folded(), N_ = n_.folded(); }
  /// Asks for its turns; both frames are markers.
  void count_angles(AngleCounter&);
  const MarkerFrame& m() const { return M_; }
  const MarkerFrame& n() const { return N_; }

  template <class T>
  T value(const MarkerOn<T>& m, const MarkerOn<T>& n, std::span<const double> s) const {
    return of_.rate || of_.kind == Kind::omega ? rate(m, n, direction(m, n)) : coordinate(m, n, s);
  }
  /// Derivative of the coordinate along the motion, by its direction; the velocity itself of kind omega.
  template <class T>
  T rate(const MarkerOn<T>& m, const MarkerOn<T>& n, const Vec3T<T>& direction) const {
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
    const Vec3T<T> a_n = n.axis(of_.axis);
    if (of_.kind != Kind::turn) return a_n;
    const Vec3T<T> a_m = m.axis(of_.axis);
    const T sum = 1.0 + a_m.dot(a_n);
    return value_of(sum) != 0 ? Vec3T<T>(T(1.0 / sum) * (a_m + a_n)) : Vec3T<T>(Vec3T<T>::Zero());
  }

 private:
  bool turns() const { return of_.kind == Kind::turn || of_.kind == Kind::omega; }
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
    const T q = 2.0 * atan2(of_.axis == 0 ? e.x : of_.axis == 1 ? e.y : e.z, e.w);
    return q + kTwoPi * std::round(((angle_ ? angle_->expected(s) : 0.0) - value_of(q)) / kTwoPi);
  }

  Of of_;
  BodyOrMarker m_, n_;
  MarkerFrame M_, N_;
  const CountedAngle* angle_ = nullptr;  // of a turn; null: no system counts it
};

}  // namespace lockstep
