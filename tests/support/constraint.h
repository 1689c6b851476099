#pragma once

/// The lock constraint alone, seven rows (rho - p, e), and every derivative of it by exact differentiation.
/// The formulas of the theory for jacobians and right sides do not occur here: this is what they are tested with.

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "tests/support/configuration.h"
#include "tests/support/dual.h"

namespace lockstep::oracle {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix6x12 = Eigen::Matrix<double, 6, 12>;
using Matrix7x12 = Eigen::Matrix<double, 7, 12>;
using Matrix6x14 = Eigen::Matrix<double, 6, 14>;
using Matrix7x14 = Eigen::Matrix<double, 7, 14>;

/// rho - p (3 rows), e (4 rows, scalar first, the identity not subtracted).
template <class T>
using Seven = std::array<T, 7>;

template <class T>
struct Bodies {
  Vec3<T> x1;
  Quat<T> q1;
  Vec3<T> x2;
  Quat<T> q2;
};

template <class T>
struct Laws {
  Vec3<T> uP;
  Quat<T> qP;
  Vec3<T> uS;
  Quat<T> qS;
  Vec3<T> p;
  Quat<T> qD;
};

/// The constraint, nothing else. The translational rows see the bodies' quaternions normalised, as (3.6) supposes; the
/// rotational rows multiply them as they are, as (4.8) supposes.
template <class T>
Seven<T> constraint(const Bodies<T>& b, const Laws<T>& l) {
  const Mat3<T> A1 = rotation(normalised(b.q1)), A2 = rotation(normalised(b.q2)), AS = rotation(l.qS);
  const Vec3<T> h = (b.x1 + A1 * l.uP) - (b.x2 + A2 * l.uS);          // (3.1)
  const Vec3<T> C = transposed(AS) * (transposed(A2) * h) - l.p;      // (3.3)
  const Quat<T> r = conjugate(l.qS) * conjugate(b.q2) * b.q1 * l.qP;  // (4.1)
  const Quat<T> e = conjugate(l.qD) * r;                              // (4.2)
  return {C.x, C.y, C.z, e.w, e.x, e.y, e.z};
}

// --- directions -----------------------------------------------------------------------------------------------------

inline Vec3<Dual2> dual(const Eigen::Vector3d& v, const Eigen::Vector3d& d, const Eigen::Vector3d& dd) {
  return {{v[0], d[0], dd[0]}, {v[1], d[1], dd[1]}, {v[2], d[2], dd[2]}};
}

inline Quat<Dual2> dual(const Eigen::Vector4d& v, const Eigen::Vector4d& d, const Eigen::Vector4d& dd) {
  return {{v[0], d[0], dd[0]}, {v[1], d[1], dd[1]}, {v[2], d[2], dd[2]}, {v[3], d[3], dd[3]}};
}

inline Vec3<Dual2> frozen(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
inline Quat<Dual2> frozen(const Eigen::Vector4d& v) { return {v[0], v[1], v[2], v[3]}; }

/// A quaternion with body-axes angular velocity w and acceleration al:
/// (1.8) qd = (1/2) q w,  (1.9) qdd = (1/2) q al - (1/4)|w|^2 q
inline Quat<Dual2> turning(const Eigen::Vector4d& q, const Eigen::Vector3d& w, const Eigen::Vector3d& al) {
  const Quat<double> a{q[0], q[1], q[2], q[3]};
  const Vec3<double> rate{w[0], w[1], w[2]};
  const Quat<double> d = 0.5 * (a * pure(rate));
  const Quat<double> dd = 0.5 * (a * pure(Vec3<double>{al[0], al[1], al[2]})) - (0.25 * dot(rate, rate)) * a;
  return {{a.w, d.w, dd.w}, {a.x, d.x, dd.x}, {a.y, d.y, dd.y}, {a.z, d.z, dd.z}};
}

inline Bodies<Dual2> frozen_bodies(const Configuration& c) {
  return {frozen(c.x1), frozen(c.q1), frozen(c.x2), frozen(c.q2)};
}

inline Laws<Dual2> frozen_laws(const Configuration& c) {
  return {frozen(c.uP), frozen(c.qP), frozen(c.uS), frozen(c.qS), frozen(c.pD), frozen(c.qD)};
}

inline Laws<Dual2> running_laws(const Configuration& c) {
  return {dual(c.uP, c.uPd, c.uPdd), dual(c.qP, c.qPd, c.qPdd), dual(c.uS, c.uSd, c.uSdd),
          dual(c.qS, c.qSd, c.qSdd), dual(c.pD, c.pDd, c.pDdd), dual(c.qD, c.qDd, c.qDdd)};
}

/// Time goes on, the bodies stand still: d = Ct, dd = Ctt.
inline Seven<Dual2> along_time(const Configuration& c) { return constraint(frozen_bodies(c), running_laws(c)); }

/// The motion with the accelerations a, al of the configuration: d = Cd, dd = Cdd.
inline Seven<Dual2> along_motion(const Configuration& c) {
  const Bodies<Dual2> b{dual(c.x1, c.v1, c.a1), turning(c.q1, c.w1, c.al1), dual(c.x2, c.v2, c.a2),
                        turning(c.q2, c.w2, c.al2)};
  return constraint(b, running_laws(c));
}

/// The motion with a = al = 0 (the quaternions turn at constant w): dd = -Qhat.
inline Seven<Dual2> along_free_motion(const Configuration& c) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Bodies<Dual2> b{dual(c.x1, c.v1, zero), turning(c.q1, c.w1, zero), dual(c.x2, c.v2, zero),
                        turning(c.q2, c.w2, zero)};
  return constraint(b, running_laws(c));
}

/// The motion with all 14 coordinate accelerations zero (the quaternions leave the unit sphere): dd = -Qc.
inline Seven<Dual2> along_straight_motion(const Configuration& c) {
  const Eigen::Vector3d zero3 = Eigen::Vector3d::Zero();
  const Eigen::Vector4d zero4 = Eigen::Vector4d::Zero();
  const Bodies<Dual2> b{dual(c.x1, c.v1, zero3), dual(c.q1, c.qd1, zero4), dual(c.x2, c.v2, zero3),
                        dual(c.q2, c.qd2, zero4)};
  return constraint(b, running_laws(c));
}

/// Velocity component k alone, time stands still: d = column k of Jh, k = 0..11 in v1, w1 (body), v2, w2 (body).
inline Seven<Dual2> along_velocity(const Configuration& c, int k) {
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const Vector12 unit = Vector12::Unit(k);
  const Bodies<Dual2> b{dual(c.x1, unit.segment<3>(0), zero), turning(c.q1, unit.segment<3>(3), zero),
                        dual(c.x2, unit.segment<3>(6), zero), turning(c.q2, unit.segment<3>(9), zero)};
  return constraint(b, frozen_laws(c));
}

/// Coordinate k alone, time stands still: d = column k of Cq, k = 0..13 in x1, q1, x2, q2.
inline Seven<Dual2> along_coordinate(const Configuration& c, int k) {
  const Eigen::Vector3d zero3 = Eigen::Vector3d::Zero();
  const Eigen::Vector4d zero4 = Eigen::Vector4d::Zero();
  const Eigen::Matrix<double, 14, 1> unit = Eigen::Matrix<double, 14, 1>::Unit(k);
  const Bodies<Dual2> b{dual(c.x1, unit.segment<3>(0), zero3), dual(c.q1, unit.segment<4>(3), zero4),
                        dual(c.x2, unit.segment<3>(7), zero3), dual(c.q2, unit.segment<4>(10), zero4)};
  return constraint(b, frozen_laws(c));
}

// --- results, 7 rows: translation in S axes (3), error quaternion (4) ------------------------------------------------

inline Vector7 values(const Seven<Dual2>& s) {
  Vector7 r;
  for (int i = 0; i < 7; ++i) r[i] = s[static_cast<std::size_t>(i)].v;
  return r;
}

inline Vector7 first_derivatives(const Seven<Dual2>& s) {
  Vector7 r;
  for (int i = 0; i < 7; ++i) r[i] = s[static_cast<std::size_t>(i)].d;
  return r;
}

inline Vector7 second_derivatives(const Seven<Dual2>& s) {
  Vector7 r;
  for (int i = 0; i < 7; ++i) r[i] = s[static_cast<std::size_t>(i)].dd;
  return r;
}

/// rho, p not subtracted (S axes).
inline Eigen::Vector3d relative_position(const Configuration& c) {
  return values(along_time(without_imposed_laws(c))).head<3>();
}

/// e, scalar first.
inline Eigen::Vector4d error_quaternion(const Configuration& c) { return values(along_time(c)).tail<4>(); }

/// C: rho - p and e - (1,0,0,0).
inline Vector7 exact_C(const Configuration& c) { return values(along_time(c)) - Vector7::Unit(3); }
inline Vector7 exact_Ct(const Configuration& c) { return first_derivatives(along_time(c)); }
inline Vector7 exact_Cd(const Configuration& c) { return first_derivatives(along_motion(c)); }
inline Vector7 exact_Cdd(const Configuration& c) { return second_derivatives(along_motion(c)); }
inline Vector7 exact_Qhat(const Configuration& c) { return -second_derivatives(along_free_motion(c)); }
inline Vector7 exact_Qc(const Configuration& c) { return -second_derivatives(along_straight_motion(c)); }

inline Matrix7x12 exact_Jh(const Configuration& c) {
  Matrix7x12 Jh;
  for (int k = 0; k < 12; ++k) Jh.col(k) = first_derivatives(along_velocity(c, k));
  return Jh;
}

inline Matrix7x14 exact_Cq(const Configuration& c) {
  Matrix7x14 Cq;
  for (int k = 0; k < 14; ++k) Cq.col(k) = first_derivatives(along_coordinate(c, k));
  return Cq;
}

/// The six rows of a mask's order x y z e1 e2 e3: without the scalar row of e.
template <int n_columns>
Eigen::Matrix<double, 6, n_columns> six(const Eigen::Matrix<double, 7, n_columns>& rows7) {
  Eigen::Matrix<double, 6, n_columns> rows6;
  rows6.template topRows<3>() = rows7.template topRows<3>();
  rows6.template bottomRows<3>() = rows7.template bottomRows<3>();
  return rows6;
}

}  // namespace lockstep::oracle
