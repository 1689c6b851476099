// SPDX-License-Identifier: BSD-3-Clause
// Vectors, matrices and quaternions whose components each have a type.
#pragma once

#include <type_traits>

#include <lockstep/math.h>

/// Vectors, matrices and quaternions as plain structs whose components each have a type: a number (double, a SIMD
/// pack, a jet), or Zero or One, which are numbers known at compile time. Adding and multiplying those costs nothing,
/// so that one text of a formula serves planar mechanisms, absent laws and parallel axes alike.
///
/// For the equations of the lock (equations.h). Everything else works with Eigen's types; vector(), matrix(), quaternion()
/// and as() convert.
namespace lockstep::vec {

/// The number 0, known at compile time.
struct Zero {};
/// The number 1, known at compile time.
struct One {};

/// Three components. Copied one by one, because a copy of the whole struct would go through memory.
template <class X, class Y = X, class Z = X>
struct Vector {
  X x;                                                   ///< first component
  Y y;                                                   ///< second component
  Z z;                                                   ///< third component
  LOCKSTEP_INLINE constexpr Vector() : x{}, y{}, z{} {}  ///< all components zero (their types' default)
  /// From its components.
  LOCKSTEP_INLINE constexpr Vector(const X& a, const Y& b, const Z& c) : x(a), y(b), z(c) {}
  /// Copies component by component.
  LOCKSTEP_INLINE constexpr Vector(const Vector& a) : x(a.x), y(a.y), z(a.z) {}
  /// Copies component by component.
  LOCKSTEP_INLINE constexpr Vector& operator=(const Vector& a) { return x = a.x, y = a.y, z = a.z, *this; }
  /// Component k, 0 to 2; only when all have one type.
  LOCKSTEP_INLINE constexpr const X& operator[](int k) const requires std::is_same_v<X, Y> && std::is_same_v<X, Z> {
    return k == 0 ? x : k == 1 ? y : z;
  }
};

/// A 3 x 3 matrix by rows, each a Vector.
template <class R0, class R1 = R0, class R2 = R0>
struct Matrix {
  R0 r0;                                       ///< first row
  R1 r1;                                       ///< second row
  R2 r2;                                       ///< third row
  static constexpr int RowsAtCompileTime = 3,  ///< as in Eigen's matrices, so that either can be an argument
      ColsAtCompileTime = 3;                   ///< likewise
  /// Element of row i and column j, 0 to 2.
  constexpr const auto& operator()(int i, int j) const { return i == 0 ? r0[j] : i == 1 ? r1[j] : r2[j]; }
};
/// Deduces the types of the rows.
template <class R0, class R1, class R2>
Matrix(R0, R1, R2) -> Matrix<R0, R1, R2>;

/// A quaternion, scalar first.
template <class W, class V>
struct Quaternion {
  W w;  ///< scalar part
  V v;  ///< vector part
};
/// Deduces the types of the parts.
template <class W, class V>
Quaternion(W, V) -> Quaternion<W, V>;

/// Whether T is a number and no Vector, Matrix or Quaternion.
template <class T>
inline constexpr bool kIsNumber = true;
/// A vector is not a number.
template <class X, class Y, class Z>
inline constexpr bool kIsNumber<Vector<X, Y, Z>> = false;
/// A matrix is not a number.
template <class X, class Y, class Z>
inline constexpr bool kIsNumber<Matrix<X, Y, Z>> = false;
/// A quaternion is not a number.
template <class W, class V>
inline constexpr bool kIsNumber<Quaternion<W, V>> = false;
/// Any type that is not a Vector, Matrix or Quaternion.
template <class T>
concept Number = kIsNumber<T>;

// -------------------------------------------------------------------------------------------------------- Zero and One

/// a + 0 = a
template <Number T>
LOCKSTEP_INLINE constexpr T operator+(const T& a, Zero) {
  return a;
}
/// 0 + a = a
template <Number T>
LOCKSTEP_INLINE constexpr T operator+(Zero, const T& a) {
  return a;
}
/// a - 0 = a
template <Number T>
LOCKSTEP_INLINE constexpr T operator-(const T& a, Zero) {
  return a;
}
/// 0 - a = -a
template <Number T>
LOCKSTEP_INLINE constexpr auto operator-(Zero, const T& a) {
  return -a;
}
/// a 0 = 0
template <Number T>
LOCKSTEP_INLINE constexpr Zero operator*(const T&, Zero) {
  return {};
}
/// 0 a = 0
template <Number T>
LOCKSTEP_INLINE constexpr Zero operator*(Zero, const T&) {
  return {};
}
/// a 1 = a
template <Number T>
LOCKSTEP_INLINE constexpr T operator*(const T& a, One) {
  return a;
}
/// 1 a = a
template <Number T>
LOCKSTEP_INLINE constexpr T operator*(One, const T& a) {
  return a;
}
LOCKSTEP_INLINE constexpr Zero operator+(Zero, Zero) { return {}; }  ///< 0 + 0 = 0
LOCKSTEP_INLINE constexpr Zero operator-(Zero, Zero) { return {}; }  ///< 0 - 0 = 0
LOCKSTEP_INLINE constexpr Zero operator-(Zero) { return {}; }        ///< -0 = 0
LOCKSTEP_INLINE constexpr Zero operator*(Zero, Zero) { return {}; }  ///< 0 0 = 0
LOCKSTEP_INLINE constexpr Zero operator*(Zero, One) { return {}; }   ///< 0 1 = 0
LOCKSTEP_INLINE constexpr Zero operator*(One, Zero) { return {}; }   ///< 1 0 = 0
LOCKSTEP_INLINE constexpr One operator*(One, One) { return {}; }     ///< 1 1 = 1

/// The component as a T.
template <class T>
LOCKSTEP_INLINE constexpr T number(const T& a) {
  return a;
}
/// 0 as a T.
template <class T>
LOCKSTEP_INLINE constexpr T number(Zero) {
  return T(0);
}
/// 1 as a T.
template <class T>
LOCKSTEP_INLINE constexpr T number(One) {
  return T(1);
}

// ------------------------------------------------------------------------------------------------------------- vectors

/// a + b
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto operator+(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return Vector{a.x + b.x, a.y + b.y, a.z + b.z};
}
/// a - b
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto operator-(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return Vector{a.x - b.x, a.y - b.y, a.z - b.z};
}
/// -a
template <class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto operator-(const Vector<X, Y, Z>& a) {
  return Vector{-a.x, -a.y, -a.z};
}
/// s a
template <Number S, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto operator*(const S& s, const Vector<X, Y, Z>& a) {
  return Vector{s * a.x, s * a.y, s * a.z};
}
/// a . b
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto dot(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// a x b
template <class X, class Y, class Z, class U, class V, class W>
LOCKSTEP_INLINE constexpr auto cross(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b) {
  return Vector{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Component k of a.
template <int k, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto get(const Vector<X, Y, Z>& a) {
  if constexpr (k == 0)
    return a.x;
  else if constexpr (k == 1)
    return a.y;
  else
    return a.z;
}

/// The zero vector.
using None = Vector<Zero, Zero, Zero>;
/// The unit vector along axis k.
template <int k>
using Unit = Vector<std::conditional_t<k == 0, One, Zero>, std::conditional_t<k == 1, One, Zero>,
                    std::conditional_t<k == 2, One, Zero>>;

// ---------------------------------------------------------------------------------------------- matrices, quaternions

/// A b
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
/// A B
template <class R0, class R1, class R2, class Q0, class Q1, class Q2>
LOCKSTEP_INLINE constexpr auto operator*(const Matrix<R0, R1, R2>& A, const Matrix<Q0, Q1, Q2>& B) {
  return Matrix{transpose_times(B, A.r0), transpose_times(B, A.r1), transpose_times(B, A.r2)};
}
/// The matrix with these columns.
template <class X, class Y, class Z, class U, class V, class W, class K, class L, class M>
LOCKSTEP_INLINE constexpr auto columns(const Vector<X, Y, Z>& a, const Vector<U, V, W>& b, const Vector<K, L, M>& c) {
  return Matrix{Vector{a.x, b.x, c.x}, Vector{a.y, b.y, c.y}, Vector{a.z, b.z, c.z}};
}
/// The unit matrix.
using Identity = Matrix<Unit<0>, Unit<1>, Unit<2>>;

/// (1.1) a b
template <class U, class X, class V, class Y>
LOCKSTEP_INLINE constexpr auto operator*(const Quaternion<U, X>& a, const Quaternion<V, Y>& b) {
  return Quaternion{a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
}
/// a + b
template <class U, class X, class V, class Y>
LOCKSTEP_INLINE constexpr auto operator+(const Quaternion<U, X>& a, const Quaternion<V, Y>& b) {
  return Quaternion{a.w + b.w, a.v + b.v};
}
/// s a
template <Number S, class W, class V>
LOCKSTEP_INLINE constexpr auto operator*(const S& s, const Quaternion<W, V>& a) {
  return Quaternion{s * a.w, s * a.v};
}
/// -a
template <class W, class V>
LOCKSTEP_INLINE constexpr auto operator-(const Quaternion<W, V>& a) {
  return Quaternion{-a.w, -a.v};
}
/// (1.2) a', the conjugate.
template <class W, class V>
LOCKSTEP_INLINE constexpr auto conjugate(const Quaternion<W, V>& a) {
  return Quaternion{a.w, -a.v};
}
/// (1.5) A(q): axes of the frame -> axes of its parent, for |q| = 1.
template <class W, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr auto rotation(const Quaternion<W, Vector<X, Y, Z>>& q) {
  const auto x2 = q.v.x + q.v.x;
  const auto y2 = q.v.y + q.v.y;
  const auto z2 = q.v.z + q.v.z;
  const auto xx = q.v.x * x2;
  const auto yy = q.v.y * y2;
  const auto zz = q.v.z * z2;
  const auto xy = q.v.x * y2;
  const auto xz = q.v.x * z2;
  const auto yz = q.v.y * z2;
  const auto wx = q.w * x2;
  const auto wy = q.w * y2;
  const auto wz = q.w * z2;
  return Matrix{Vector{1.0 - (yy + zz), xy - wz, xz + wy}, Vector{xy + wz, 1.0 - (xx + zz), yz - wx},
                Vector{xz - wy, yz + wx, 1.0 - (xx + yy)}};
}
/// The quaternion 1.
using NoTurn = Quaternion<One, None>;

// ------------------------------------------------------------------------------------------------- from and to Eigen

/// The Vector of three numbers a[0], a[1], a[2].
template <class A>
LOCKSTEP_INLINE constexpr auto vector(const A& a) {
  return Vector{a[0], a[1], a[2]};
}
/// The Matrix of the 3 x 3 elements a(i, j).
template <class A>
LOCKSTEP_INLINE constexpr auto matrix(const A& a) {
  return Matrix{Vector{a(0, 0), a(0, 1), a(0, 2)}, Vector{a(1, 0), a(1, 1), a(1, 2)},
                Vector{a(2, 0), a(2, 1), a(2, 2)}};
}
/// The Quaternion of a QuatT.
template <class Q>
LOCKSTEP_INLINE constexpr auto quaternion(const Q& q) {
  return Quaternion{q.w, Vector{q.x, q.y, q.z}};
}
/// The vector with all components as numbers T.
template <class T, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr Vector<T> numbers(const Vector<X, Y, Z>& a) {
  return {number<T>(a.x), number<T>(a.y), number<T>(a.z)};
}
/// The vector as an A, an Eigen vector of three numbers T.
template <class A, class T = typename A::Scalar, class X, class Y, class Z>
LOCKSTEP_INLINE constexpr A as(const Vector<X, Y, Z>& a) {
  return A(number<T>(a.x), number<T>(a.y), number<T>(a.z));
}

}  // namespace lockstep::vec
