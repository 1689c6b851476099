// SPDX-License-Identifier: BSD-3-Clause
// Vectors, matrices, quaternions and poses.
#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include <lockstep/detail/export.h>

namespace lockstep {

// The vectors and matrices of lockstep: Eigen's, under the theory's names. T is double, a jet or another number type.

/// Column of three numbers.
template <class T>
using Vec3T = Eigen::Matrix<T, 3, 1>;
/// Column of four numbers.
template <class T>
using Vec4T = Eigen::Matrix<T, 4, 1>;
/// 3 x 3 matrix.
template <class T>
using Mat3T = Eigen::Matrix<T, 3, 3>;
/// 3 x 4 matrix.
template <class T>
using Mat34T = Eigen::Matrix<T, 3, 4>;
using Vec3 = Vec3T<double>;                ///< column of three numbers
using Vec4 = Vec4T<double>;                ///< column of four numbers, quaternions with the scalar first
using Mat3 = Mat3T<double>;                ///< 3 x 3 matrix
using Mat34 = Mat34T<double>;              ///< 3 x 4 matrix
using Vec6 = Eigen::Matrix<double, 6, 1>;  ///< column of six: translation first, then rotation
using Mat6 = Eigen::Matrix<double, 6, 6>;  ///< 6 x 6 matrix in the order of Vec6
using VecX = Eigen::VectorXd;              ///< column of any length
using MatX = Eigen::MatrixXd;              ///< matrix of any size

inline constexpr double kPi = std::numbers::pi;           ///< half a revolution, rad
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  ///< a full revolution, rad
inline constexpr double kParallel = 1e-9;  ///< sine of the angle up to which two directions count as parallel

/// a x b. Eigen's own cross would include its geometry module in every file.
template <class A, class B>
inline Vec3T<typename A::Scalar> cross(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Whether two directions are parallel or opposed; both of length 1, or one of them shorter.
LOCKSTEP_API bool are_parallel(const Vec3& a, const Vec3& b);
/// Whether two directions are perpendicular; lengths as above.
LOCKSTEP_API bool are_perpendicular(const Vec3& a, const Vec3& b);

/// a~, the matrix of the cross product: a~ b = a x b.
template <class A>
inline Mat3T<typename A::Scalar> skew(const Eigen::MatrixBase<A>& a) {
  using T = typename A::Scalar;
  Mat3T<T> m;
  m << T(0), -a[2], a[1], a[2], T(0), -a[0], -a[1], a[0], T(0);
  return m;
}

// Quaternions, scalar first (theory, section 1).

/// A quaternion w + x i + y j + z k, by default 1. Unit quaternions are orientations: frame's axes -> parent's axes.
template <class T>
struct QuatT {
  T w{1},    ///< scalar part
      x{0},  ///< first component of the vector part
      y{0},  ///< second
      z{0};  ///< third

  Vec3T<T> vec() const { return {x, y, z}; }              ///< the vector part
  Vec4T<T> coefficients() const { return {w, x, y, z}; }  ///< (w, x, y, z)
  /// From scalar and vector part.
  static QuatT from(const T& scalar, const Vec3T<T>& v) { return {scalar, v[0], v[1], v[2]}; }
  /// From four coefficients, scalar first.
  template <class D>
  static QuatT from(const Eigen::MatrixBase<D>& c) {
    return {c[0], c[1], c[2], c[3]};
  }
};
using Quat = QuatT<double>;  ///< a quaternion of doubles

/// (1.1) a b, 16 multiplications and 12 additions.
template <class T>
inline QuatT<T> operator*(const QuatT<T>& a, const QuatT<T>& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
/// Sum of the coefficients.
template <class T>
inline QuatT<T> operator+(const QuatT<T>& a, const QuatT<T>& b) {
  return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}
/// All coefficients negated: of a unit quaternion, the same orientation.
template <class T>
inline QuatT<T> operator-(const QuatT<T>& a) {
  return {-a.w, -a.x, -a.y, -a.z};
}

/// (1.2) a', the conjugate; the inverse of a unit quaternion.
template <class T>
inline QuatT<T> conjugate(const QuatT<T>& a) {
  return {a.w, -a.x, -a.y, -a.z};
}

/// |a|^2, the sum of the squared coefficients.
template <class T>
inline T norm2(const QuatT<T>& a) {
  return a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z;
}

/// a/|a|. |a| must not be zero.
template <class T>
inline QuatT<T> normalized(const QuatT<T>& a) {
  using std::sqrt;
  const T s = T(1) / sqrt(norm2(a));
  return {a.w * s, a.x * s, a.y * s, a.z * s};
}

/// (1.5) A(q): axes of the frame -> axes of its parent, for |q| = 1.
template <class T>
inline Mat3T<T> rotation(const QuatT<T>& q) {
  const T x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const T xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
  const T wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  Mat3T<T> A;
  A << T(1) - (yy + zz), xy - wz, xz + wy, xy + wz, T(1) - (xx + zz), yz - wx, xz - wy, yz + wx, T(1) - (xx + yy);
  return A;
}

/// (1.6) G(q) = 2 [ -qv | q0 1 - qv~ ], 3x4: w = G qd in body axes.
template <class T>
inline Mat34T<T> G_matrix(const QuatT<T>& q) {
  const T w = q.w + q.w, x = q.x + q.x, y = q.y + q.y, z = q.z + q.z;
  Mat34T<T> G;
  G << -x, w, z, -y, -y, -z, w, x, -z, y, -x, w;
  return G;
}

/// (1.8) qd = (1/2) q w, w in body axes.
template <class T>
inline QuatT<T> rate(const QuatT<T>& q, const Vec3T<T>& w) {
  const T h(0.5);
  return q * QuatT<T>{T(0), h * w[0], h * w[1], h * w[2]};
}

/// (1.9) qdd = (1/2) q al - (1/4)|w|^2 q; angular velocity w and acceleration al in body axes.
template <class T>
inline QuatT<T> second_rate(const QuatT<T>& q, const Vec3T<T>& w, const Vec3T<T>& al) {
  const T h(0.5);
  return q * QuatT<T>{T(-0.25) * w.dot(w), h * al[0], h * al[1], h * al[2]};
}

/// (1.12) exponential: the quaternion of the rotation by |th|, rad, about th; a series below |th| = 1e-2.
LOCKSTEP_API Quat exponential(const Vec3& th);

/// (1.12) Cayley: 1 + th/2, normalised; a rotation by 2 atan(|th|/2), rad, about th.
inline Quat cayley(const Vec3& th) { return normalized(Quat{1.0, 0.5 * th[0], 0.5 * th[1], 0.5 * th[2]}); }

/// (1.12) rotation vector of the unit quaternion q, rad, of length in [0, pi]; q and -q give the same.
template <class T>
Vec3T<T> rotation_vector(const QuatT<T>& q) {
  using std::atan2, std::sqrt;
  const double sign = q.w < 0 ? -1.0 : 1.0;
  const Vec3T<T> v = sign * q.vec();
  const T n = sqrt(v.dot(v));
  if (n < 1e-8) return 2.0 * v;  // atan2(n, w)/n -> 1/w -> 1, the error is n^2/6
  return T(2.0 * atan2(n, T(sign * q.w)) / n) * v;
}

/// Quaternion of the rotation by `angle` (rad) about the axis `n` (any length but zero).
LOCKSTEP_API Quat axis_angle(const Vec3& n, double angle);

/// Unit quaternion of a rotation matrix, from its largest component, so that no division is by a small number.
LOCKSTEP_API Quat quaternion_of(const Mat3& A);

// Pose: position and orientation of a frame in its parent. Twist: its velocity and angular velocity.

/// Position and orientation of a frame in its parent.
struct Pose {
  Vec3 x = Vec3::Zero();  ///< the frame's origin in the parent's axes, m
  Quat q;                 ///< frame's axes -> parent's axes, unit, scalar first
};

/// Velocity and angular velocity of a frame against its parent.
struct Twist {
  Vec3 v = Vec3::Zero();  ///< velocity of the origin, in the parent's axes, m/s
  Vec3 w = Vec3::Zero();  ///< angular velocity in the frame's own axes, rad/s
};

/// The pose of c in the parent of a, when b is the pose of c in a.
LOCKSTEP_API Pose operator*(const Pose& a, const Pose& b);

/// The pose of the parent in the frame.
LOCKSTEP_API Pose inverse(const Pose& a);

}  // namespace lockstep
