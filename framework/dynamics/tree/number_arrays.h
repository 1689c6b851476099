// SPDX-License-Identifier: BSD-3-Clause
// Vectors, matrices and quaternions in arrays of numbers of any type.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include <lockstep/detail/vec.h>
#include "framework/dynamics/tree/number_kinds.h"
#include "framework/dynamics/tree/spaces.h"

namespace lockstep::numbers {

/// The number of an array A: [i] is number i, + i what begins there.
template <class A>
using NumberIn = std::remove_cvref_t<decltype(std::declval<A>()[0])>;
template <class A>
using VectorIn = vec::Vector<NumberIn<A>>;
template <class A>
using MatrixIn = vec::Matrix<VectorIn<A>>;
template <class A>
using QuaternionIn = PackQuat<NumberIn<A>>;

template <class A>
LOCKSTEP_INLINE VectorIn<A> load3(const A& p, std::size_t at) {
  return {p[at], p[at + 1], p[at + 2]};
}
template <class A>
LOCKSTEP_INLINE MatrixIn<A> load9(const A& p, std::size_t at) {
  return {load3(p, at), load3(p, at + 3), load3(p, at + 6)};
}
template <class A>
LOCKSTEP_INLINE QuaternionIn<A> load4(const A& p, std::size_t at) {
  return {p[at], load3(p, at + 1)};
}
template <class A>
LOCKSTEP_INLINE bodies::Symmetric<NumberIn<A>> load_symmetric(const A& p, std::size_t at) {
  return {p[at], p[at + 1], p[at + 2], p[at + 3], p[at + 4], p[at + 5]};
}

template <class A, class X>
LOCKSTEP_INLINE void store(const A& p, std::size_t at, const X& x) {
  if constexpr (std::is_same_v<X, vec::Zero>)
    p[at] = NumberIn<A>{};
  else if constexpr (std::is_same_v<X, vec::One>)
    p[at] = NumberIn<A>{} + 1.0;
  else
    p[at] = x;
}
/// Absent components are left as they are.
template <class A, class X, class Y, class Z>
LOCKSTEP_INLINE void store3(const A& p, std::size_t at, const vec::Vector<X, Y, Z>& v) {
  if constexpr (!std::is_same_v<X, vec::Zero>) p[at] = v.x;
  if constexpr (!std::is_same_v<Y, vec::Zero>) p[at + 1] = v.y;
  if constexpr (!std::is_same_v<Z, vec::Zero>) p[at + 2] = v.z;
}
template <class A, class V>
LOCKSTEP_INLINE void store4(const A& p, std::size_t at, const vec::Quaternion<NumberIn<A>, V>& q) {
  p[at] = q.w, store3(p, at + 1, q.v);
}
template <class A, class R0, class R2>
LOCKSTEP_INLINE void store9(const A& p, std::size_t at, const vec::Matrix<R0, R0, R2>& m) {
  store3(p, at, m.r0), store3(p, at + 3, m.r1);
  if constexpr (std::is_same_v<R0, R2>) store3(p, at + 6, m.r2);
}

/// What moves in space: vectors, axial ones, matrices and quaternions in arrays.
template <class A>
struct Spatial {
  using Array = A;
  using T = NumberIn<A>;
  using L = VectorIn<A>;
  using W = L;
  using M3 = MatrixIn<A>;
  using Q4 = QuaternionIn<A>;
  using Space = bodies::InSpace<T>;
  static constexpr bool kFlat = false;
  LOCKSTEP_INLINE static L linear(const A& p, std::size_t at) { return load3(p, at); }
  LOCKSTEP_INLINE static W axial(const A& p, std::size_t at) { return load3(p, at); }
  LOCKSTEP_INLINE static M3 matrix(const A& p, std::size_t at) { return load9(p, at); }
  LOCKSTEP_INLINE static Q4 quaternion(const A& p, std::size_t at) { return load4(p, at); }
  LOCKSTEP_INLINE static M3 axes(const Q4& e) { return rotation(e); }
};
/// In a plane, whose normal is the third axis: what lies out of it is absent.
template <class A>
struct Planar {
  using Array = A;
  using T = NumberIn<A>;
  using L = vec::Vector<T, T, vec::Zero>;
  using W = vec::Vector<vec::Zero, vec::Zero, T>;
  using M3 = vec::Matrix<L, L, vec::Unit<2>>;
  using Q4 = vec::Quaternion<T, W>;
  using Space = bodies::InPlane<T>;
  static constexpr bool kFlat = true;
  LOCKSTEP_INLINE static L linear(const A& p, std::size_t at) { return {p[at], p[at + 1], {}}; }
  LOCKSTEP_INLINE static W axial(const A& p, std::size_t at) { return {{}, {}, p[at + 2]}; }
  LOCKSTEP_INLINE static M3 matrix(const A& p, std::size_t at) { return {linear(p, at), linear(p, at + 3), {}}; }
  LOCKSTEP_INLINE static Q4 quaternion(const A& p, std::size_t at) { return {p[at], axial(p, at + 1)}; }
  LOCKSTEP_INLINE static M3 axes(const Q4& e) {
    const auto A3 = rotation(e);
    return {A3.r0, A3.r1, {}};
  }
};

}  // namespace lockstep::numbers
