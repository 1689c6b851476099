// The vectors and matrices of lockstep: Eigen's, under the theory's names. T is double, a jet or a counting number.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "framework/foundation/support/built_with.h"

namespace lockstep {

template <class T>
using Vec3T = Eigen::Matrix<T, 3, 1>;
template <class T>
using Vec4T = Eigen::Matrix<T, 4, 1>;
template <class T>
using Mat3T = Eigen::Matrix<T, 3, 3>;
template <class T>
using Mat34T = Eigen::Matrix<T, 3, 4>;
using Vec3 = Vec3T<double>;
using Vec4 = Vec4T<double>;
using Mat3 = Mat3T<double>;
using Mat34 = Mat34T<double>;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using VecX = Eigen::VectorXd;
using MatX = Eigen::MatrixXd;

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// a x b; Eigen's own cross would bring its whole geometry module into every file.
template <class A, class B>
inline Vec3T<typename A::Scalar> cross(const Eigen::MatrixBase<A>& a, const Eigen::MatrixBase<B>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// a~, the matrix of the cross product: a~ b = a x b.
template <class A>
inline Mat3T<typename A::Scalar> skew(const Eigen::MatrixBase<A>& a) {
  using T = typename A::Scalar;
  Mat3T<T> m;
  m << T(0), -a[2], a[1], a[2], T(0), -a[0], -a[1], a[0], T(0);
  return m;
}

}  // namespace lockstep
