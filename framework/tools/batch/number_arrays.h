// Vectors, matrices and quaternions in arrays of numbers: packs, in lanes, or any other. Private to the room.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include <lockstep/vec.h>
#include "framework/dynamics/tree/number_kinds.h"
#include "framework/dynamics/tree/spaces.h"

#define LOCKSTEP_LANE LOCKSTEP_INLINE

namespace lockstep::lanes {

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
using SpaceOf = bodies::InSpace<NumberIn<A>>;

template <class A>
LOCKSTEP_LANE VectorIn<A> load3(const A& p, std::size_t at) {
  return {p[at], p[at + 1], p[at + 2]};
}
template <class A>
LOCKSTEP_LANE MatrixIn<A> load9(const A& p, std::size_t at) {
  return {load3(p, at), load3(p, at + 3), load3(p, at + 6)};
}
template <class A>
LOCKSTEP_LANE QuaternionIn<A> load4(const A& p, std::size_t at) {
  return {p[at], load3(p, at + 1)};
}
template <class A>
LOCKSTEP_LANE bodies::Symmetric<NumberIn<A>> load_symmetric(const A& p, std::size_t at) {
  return {p[at], p[at + 1], p[at + 2], p[at + 3], p[at + 4], p[at + 5]};
}

template <class A, class X>
LOCKSTEP_LANE void store(const A& p, std::size_t at, const X& x) {
  if constexpr (std::is_same_v<X, vec::Zero>)
    p[at] = NumberIn<A>{};
  else if constexpr (std::is_same_v<X, vec::One>)
    p[at] = NumberIn<A>{} + 1.0;
  else
    p[at] = x;
}
template <class A, class X, class Y, class Z>
LOCKSTEP_LANE void store3(const A& p, std::size_t at, const vec::Vector<X, Y, Z>& v) {
  store(p, at, v.x), store(p, at + 1, v.y), store(p, at + 2, v.z);
}
template <class A>
LOCKSTEP_LANE void store4(const A& p, std::size_t at, const QuaternionIn<A>& q) {
  p[at] = q.w, store3(p, at + 1, q.v);
}
template <class A>
LOCKSTEP_LANE void store9(const A& p, std::size_t at, const MatrixIn<A>& m) {
  store3(p, at, m.r0), store3(p, at + 3, m.r1), store3(p, at + 6, m.r2);
}

template <class T>
LOCKSTEP_LANE T larger(const T& a, const T& b) {
  return a > b ? a : b;
}
/// The larger one; a NaN stays.
template <class T>
LOCKSTEP_LANE T largest_or_nan(const T& most, const T& x) {
  const T next = x <= most ? most : x;
  return most != most ? most : next;
}

}  // namespace lockstep::lanes
