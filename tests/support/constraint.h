// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// The lock constraint alone, seven rows (rho - p, e), and every derivative of it by exact differentiation.
/// The formulas of the theory for jacobians and right sides do not occur here: this is what they are tested with.

#include <array>

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

// --- directions: the constraint with its first and second derivative along a curve ------------------------------------

/// Time goes on, the bodies stand still: d = Ct, dd = Ctt.
Seven<Dual2> along_time(const Configuration&);
/// The motion with the accelerations a, al of the configuration: d = Cd, dd = Cdd.
Seven<Dual2> along_motion(const Configuration&);
/// The motion with a = al = 0 (the quaternions turn at constant w): dd = -Qhat.
Seven<Dual2> along_free_motion(const Configuration&);
/// The motion with all 14 coordinate accelerations zero (the quaternions leave the unit sphere): dd = -Qc.
Seven<Dual2> along_straight_motion(const Configuration&);
/// Velocity component k alone, time stands still: d = column k of Jh, k = 0..11 in v1, w1 (body), v2, w2 (body).
Seven<Dual2> along_velocity(const Configuration&, int k);
/// Coordinate k alone, time stands still: d = column k of Cq, k = 0..13 in x1, q1, x2, q2.
Seven<Dual2> along_coordinate(const Configuration&, int k);

// --- results, 7 rows: translation in S axes (3), error quaternion (4) ------------------------------------------------

/// rho, p not subtracted (S axes).
Eigen::Vector3d relative_position(const Configuration&);
/// e, scalar first.
Eigen::Vector4d error_quaternion(const Configuration&);

/// C: rho - p and e - (1,0,0,0).
Vector7 exact_C(const Configuration&);
Vector7 exact_Ct(const Configuration&);
Vector7 exact_Cd(const Configuration&);
Vector7 exact_Cdd(const Configuration&);
Vector7 exact_Qhat(const Configuration&);
Vector7 exact_Qc(const Configuration&);
Matrix7x12 exact_Jh(const Configuration&);
Matrix7x14 exact_Cq(const Configuration&);

/// The six rows of a mask's order x y z e1 e2 e3: without the scalar row of e.
template <int n_columns>
Eigen::Matrix<double, 6, n_columns> six(const Eigen::Matrix<double, 7, n_columns>& rows7) {
  Eigen::Matrix<double, 6, n_columns> rows6;
  rows6.template topRows<3>() = rows7.template topRows<3>();
  rows6.template bottomRows<3>() = rows7.template bottomRows<3>();
  return rows6;
}

}  // namespace lockstep::oracle
