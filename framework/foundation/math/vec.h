// Vectors, matrices and quaternions as plain structs, each component of a type of its own: a number (double, a pack of
// lanes, a jet, a counting number), or Zero or One, which are numbers known from their type. What is multiplied by or
// added to those costs nothing, so that one text of a formula serves the plane, absent laws and parallel axes alike.
//
// For the kernel of the lock (mechanism/lock/equations.h). Everything else works on Eigen's types (types.h); vector(),
// matrix() and put() lead from one to the other.
#pragma once

#include <type_traits>

#include "framework/foundation/support/clones.h"

namespace lockstep::vec {

struct Zero {};
struct One {};

/// Copied number by number: whole structs would be copied through memory.
template <class X, class Y = X, class Z = X>
struct Vector {
  X x;
  Y y;
  Z z;
  LOCKSTEP_INLINE constexpr Vector() : x{}, y{}, z{} {}
  LOCKSTEP_INLINE constexpr Vector(const X& a, const Y& b, const Z& c) : x(a), y(b), z(c) {}
  LOCKSTEP_INLINE constexpr Vector(const Vector& a) : x(a.x), y(a.y), z(a.z) {}
  LOCKSTEP_INLINE constexpr Vector& operator=(const Vector& a) { return x = a.x, y = a.y, z = a.z, *this; }
  LOCKSTEP_INLINE constexpr const X& operator[](int k) const requires std::is_same_v<X, Y> && std::is_same_v<X, Z> {
    return k == 0 ? x : k == 1 ? y : z;
  }
};

/// Rows r0 r1 r2.
template <class R0, class R1 = R0, class R2 = R0>
struct Matrix {
  R0 r0;
  R1 r1;
  R2 r2;
  static constexpr int RowsAtCompileTime = 3, ColsAtCompileTime = 3;  ///< where Eigen's matrices may stand as well
  constexpr const auto& operator()(int i, int j) const { return i == 0 ? r0[j] : i == 1 ? r1[j] : r2[j]; }
};
template <class R0, class R1, class R2>
Matrix(R0, R1, R2) -> Matrix<R0, R1, R2>;

/// Scalar part w, vector part v.
template <class W, class V>
struct Quaternion {
  W w;
  V v;
};
template <class W, class V>
Quaternion(W, V) -> Quaternion<W, V>;

template <class T>
inline constexpr bool kIsNumber = true;
template <class X, class Y, class Z>
inline constexpr bool kIsNumber<Vector<X, Y, Z>> = false;
template <class X, class Y, class Z>
inline constexpr bool kIsNumber<Matrix<X, Y, Z>> = false;
template <class W, class V>
inline constexpr bool kIsNumber<Quaternion<W, V>> = false;
template <class T>
concept Number = kIsNumber<T>;

// -------------------------------------------------------------------------------------------------------- Zero and One

template <Number T>
LOCKSTEP_INLINE constexpr T operator+(const T& a, Zero) {
  return a;
}
template <Number T>
LOCKSTEP_INLINE constexpr T operator+(Zero, const T& a) {
  return a;
}
template <Number T>
LOCKSTEP_INLINE constexpr T operator-(const T& a, Zero) {
  return a;
}
template <Number T>
LOCKSTEP_INLINE constexpr auto operator-(Zero, const T& a) {
  return -a;
}
template <Number T>
LOCKSTEP_INLINE constexpr Zero operator*(const T&, Zero) {
  return {};
}
template <Number T>
LOCKSTEP_INLINE constexpr Zero operator*(Zero, const T&) {
  return {};
}
template <Number T>
LOCKSTEP_INLINE constexpr T operator*(const T& a, One) {
  return a;
}
template <Number T>
LOCKSTEP_INLINE constexpr T operator*(One, const T& a) {
  return a;
}
LOCKSTEP_INLINE constexpr Zero operator+(Zero, Zero) { return {}; }
LOCKSTEP_INLINE constexpr Zero operator-(Zero, Zero) { return {}; }
LOCKSTEP_INLINE constexpr Zero operator-(Zero) { return {}; }
LOCKSTEP_INLINE constexpr Zero operator*(Zero, Zero) { return {}; }
LOCKSTEP_INLINE constexpr Zero operator*(Zero, One) { return {}; }
LOCKSTEP_INLINE constexpr Zero operator*(One, Zero) { return {}; }
LOCKSTEP_INLINE constexpr One operator*(One, One) { return {}; }

/// The component as a T.
template <class T>
LOCKSTEP_INLINE constexpr T number(const T& a) {
  return a;
}
template <class T>
LOCKSTEP_INLINE constexpr T number(Zero) {
  return T(0);
}
template <class T>
LOCKSTEP_INLINE constexpr T number(One) {
  return T(1);
}

// ------------------------------------------------------------------------------------------------------------- vectors

template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto operator+(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return Vector{a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto operator-(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return Vector{a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto operator-(const Vector<X, Y, Z>& a) {
  return Vector{-a.x, -a.y, -a.z};
}
template <Number S, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto operator*(const S& s, const Vector<X, Y, Z>& a) {
  return Vector{s * a.x, s * a.y, s * a.z};
}
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto dot(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto cross(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return Vector{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Component k.
template <int k, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto get(const Vector<X, Y, Z>& a) {
  if constexpr (k == 0)
    return a.x;
  else if constexpr (k == 1)
    return a.y;
  else
    return a.z;
}

using None = Vector<Zero, Zero, Zero>;
/// The unit vector along axis k.
template <int k>
using Unit = Vector<std::conditional_t<k == 0, One, Zero>, std::conditional_t<k == 1, One, Zero>,
                    std::conditional_t<k == 2, One, Zero>>;

// ---------------------------------------------------------------------------------------------- matrices, quaternions

template <class R0, class R1, class R2, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto operator*(const Matrix<R0, R1, R2>& A, const Vector<X, Y, Z>& b) {
  return Vector{dot(A.r0, b), dot(A.r1, b), dot(A.r2, b)};
}
/// A^T b
template <class R0, class R1, class R2, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto transpose_times(const Matrix<R0, R1, R2>& A, const Vector<X, Y, Z>& b) {
  return Vector{A.r0.x * b.x + A.r1.x * b.y + A.r2.x * b.z, A.r0.y * b.x + A.r1.y * b.y + A.r2.y * b.z,
                A.r0.z * b.x + A.r1.z * b.y + A.r2.z * b.z};
}
template <class R0, class R1, class R2, class Q0, class Q1, class Q2>
LOCKSTEP_INLINE constexpr auto operator*(const Matrix<R0, R1, R2>& A, const Matrix<Q0, Q1, Q2>& B) {
  return Matrix{transpose_times(B, A.r0), transpose_times(B, A.r1), transpose_times(B, A.r2)};
}
/// The matrix with these columns.
template <class X, class Y, class Z, class U, class V, class W, class K, class L, class M>
LOCKSTEP_INLINE constexpr auto columns(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b, const Vector<K, L, M>& c) {
  return Matrix{Vector{a.x, b.x, c.x}, Vector{a.y, b.y, c.y}, Vector{a.z, b.z, c.z}};
}
using Identity = Matrix<Unit<0>, Unit<1>, Unit<2>>;

/// (1.1)
template <class U, class X, class V, class Y>
LOCKSTEP_INLINE constexpr auto operator*(const Quaternion<U, X>& a, const Quaternion<V, Y>& b) {
  return Quaternion{a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}
template <class U, class X, class V, class Y>
LOCKSTEP_INLINE constexpr auto operator+(const Quaternion<U, X>& a, const Quaternion<V, Y>& b) {
  return Quaternion{a.w + b.w, a.v + b.v};
}
template <Number S, class W, class V>
LOCKSTEP_INLINE constexpr auto operator*(const S& s, const Quaternion<W, V>& a) {
  return Quaternion{s * a.w, s * a.v};
}
template <class W, class V>
LOCKSTEP_INLINE constexpr auto operator-(const Quaternion<W, V>& a) {
  return Quaternion{-a.w, -a.v};
}
/// (1.2)
template <class W, class V>
LOCKSTEP_INLINE constexpr auto conjugate(const Quaternion<W, V>& a) {
  return Quaternion{a.w, -a.v};
}
/// (1.5), |q| = 1
template <class W, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto rotation(const Quaternion<W, Vector<X, Y, Z>>& q) {
  const auto x2 = q.v.x + q.v.x;
  const auto y2 = q.v.y + q.v.y;
  const auto z2 = q.v.z + q.v.z;
  const auto xx = q.v.x * x2, yy = q.v.y * y2, zz = q.v.z * z2, xy = q.v.x * y2, xz = q.v.x * z2, yz = q.v.y * z2;
  const auto wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  return Matrix{Vector{1.0 - (yy + zz), xy - wz, xz + wy}, Vector{xy + wz, 1.0 - (xx + zz), yz - wx},
                Vector{xz - wy, yz + wx, 1.0 - (xx + yy)}};
}
using NoTurn = Quaternion<One, None>;

// ------------------------------------------------------------------------------------------------- from and to Eigen

template <class A>
LOCKSTEP_INLINE constexpr auto vector(const A& a) {
  return Vector{a[0], a[1], a[2]};
}
template <class A>
LOCKSTEP_INLINE constexpr auto matrix(const A& a) {
  return Matrix{Vector{a(0, 0), a(0, 1), a(0, 2)}, Vector{a(1, 0), a(1, 1), a(1, 2)},
                Vector{a(2, 0), a(2, 1), a(2, 2)}};
}
template <class Q>
LOCKSTEP_INLINE constexpr auto quaternion(const Q& q) {
  return Quaternion{q.w, Vector{q.x, q.y, q.z}};
}
/// All components as numbers T.
template <class T, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr Vector<T> numbers(const Vector<X, Y, Z>& a) {
  return {number<T>(a.x), number<T>(a.y), number<T>(a.z)};
}
/// The vector as an A of three numbers T.
template <class A, class T = typename A::Scalar, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr A as(const Vector<X, Y, Z>& a) {
  return A(number<T>(a.x), number<T>(a.y), number<T>(a.z));
}

}  // namespace lockstep::vec
