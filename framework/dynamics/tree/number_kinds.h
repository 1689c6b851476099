// SPDX-License-Identifier: BSD-3-Clause
// Where Eigen's vectors, matrices and quaternions are spelt otherwise than those of vec.h, for texts that serve both.
#pragma once

#include <lockstep/detail/vec.h>
#include <lockstep/math.h>

namespace lockstep {

template <class T>
using PackQuat = vec::Quaternion<T, vec::Vector<T>>;

LOCKSTEP_INLINE Quat quaternion(double w, const Vec3& v) { return Quat::from(w, v); }
template <class T, class X, class Y, class Z>
LOCKSTEP_INLINE vec::Quaternion<T, vec::Vector<X, Y, Z>> quaternion(const T& w, const vec::Vector<X, Y, Z>& v) {
  return {w, v};
}
LOCKSTEP_INLINE Quat scaled(double x, const Quat& q) { return {x * q.w, x * q.x, x * q.y, x * q.z}; }
template <class T, class V>
LOCKSTEP_INLINE vec::Quaternion<T, V> scaled(const T& x, const vec::Quaternion<T, V>& q) {
  return x * q;
}
LOCKSTEP_INLINE Vec3 vector_of(const Quat& q) { return q.vec(); }
template <class T, class V>
LOCKSTEP_INLINE V vector_of(const vec::Quaternion<T, V>& q) {
  return q.v;
}
template <class T, class V>
LOCKSTEP_INLINE T norm2(const vec::Quaternion<T, V>& q) {
  return q.w * q.w + dot(q.v, q.v);
}

/// The quaternion of four numbers from a[i] on.
template <class V3, class Numbers>
LOCKSTEP_INLINE auto quaternion_at(Numbers a, int i) {
  return quaternion(a[i], V3(a[i + 1], a[i + 2], a[i + 3]));
}
/// The small rotation by which dr changes r, axes of the turned frame: twice the vector part of r' dr, for any |r|.
template <class Q4>
LOCKSTEP_INLINE auto turned_by(const Q4& r, const Q4& dr) -> decltype(vector_of(r)) {
  return (2.0 / norm2(r)) * vector_of(conjugate(r) * dr);
}

/// Products of unit quaternions are of unit length to round-off; along a chain that adds up: one step of Newton's.
template <class Q4>
LOCKSTEP_INLINE Q4 near_unit(const Q4& q) {
  const auto n2 = norm2(q);
  return scaled(decltype(norm2(q))(1.5 - 0.5 * n2), q);
}

/// The vector a as a V3, which may have components of other types.
template <class V3, class A>
LOCKSTEP_INLINE V3 to(const A& a) {
  if constexpr (std::is_constructible_v<V3, const A&>)
    return V3(a);
  else
    return V3() + a;
}

template <class V3>
LOCKSTEP_INLINE V3 zero_vector() {
  if constexpr (requires { V3::Zero(); })
    return V3::Zero();
  else
    return V3();
}
LOCKSTEP_INLINE double& component(Vec3& a, int k) { return a[k]; }
template <class T>
LOCKSTEP_INLINE T& component(vec::Vector<T>& a, int k) {
  return k == 0 ? a.x : k == 1 ? a.y : a.z;
}
LOCKSTEP_INLINE Vec3 column_of(const Mat3& A, int k) { return A.col(k); }
template <class T>
LOCKSTEP_INLINE vec::Vector<T> column_of(const vec::Matrix<vec::Vector<T>>& A, int k) {
  return {A.r0[k], A.r1[k], A.r2[k]};
}

}  // namespace lockstep
