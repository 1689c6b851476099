// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Exact derivatives along one direction, for the oracles of the tests: nothing here is shared with the library.
/// Number, vector, quaternion and rotation matrix are plain structs, templates on the number type.

#include <cmath>
#include <compare>

namespace lockstep::oracle {

/// f, f' and f'' with respect to one parameter; arithmetic is exact but for rounding. Compared by the value alone.
struct Dual2 {
  double v = 0.0;
  double d = 0.0;
  double dd = 0.0;

  constexpr Dual2() = default;
  constexpr Dual2(double value) : v(value) {}  // a constant; implicit, as numbers are
  constexpr Dual2(double value, double first, double second) : v(value), d(first), dd(second) {}

  /// The parameter itself at the value given.
  static constexpr Dual2 parameter(double value) { return {value, 1.0, 0.0}; }

  friend constexpr Dual2 operator+(const Dual2& a, const Dual2& b) { return {a.v + b.v, a.d + b.d, a.dd + b.dd}; }
  friend constexpr Dual2 operator-(const Dual2& a, const Dual2& b) { return {a.v - b.v, a.d - b.d, a.dd - b.dd}; }
  friend constexpr Dual2 operator-(const Dual2& a) { return {-a.v, -a.d, -a.dd}; }

  /// (a b)'' = a'' b + 2 a' b' + a b''
  friend constexpr Dual2 operator*(const Dual2& a, const Dual2& b) {
    return {a.v * b.v, a.d * b.v + a.v * b.d, a.dd * b.v + 2.0 * a.d * b.d + a.v * b.dd};
  }

  /// From a = f b: f' = (a' - f b') / b, f'' = (a'' - 2 f' b' - f b'') / b
  friend constexpr Dual2 operator/(const Dual2& a, const Dual2& b) {
    const double f = a.v / b.v;
    const double fd = (a.d - f * b.d) / b.v;
    return {f, fd, (a.dd - 2.0 * fd * b.d - f * b.dd) / b.v};
  }

  constexpr Dual2& operator+=(const Dual2& b) { return *this = *this + b; }
  constexpr Dual2& operator-=(const Dual2& b) { return *this = *this - b; }
  constexpr Dual2& operator*=(const Dual2& b) { return *this = *this * b; }
  constexpr Dual2& operator/=(const Dual2& b) { return *this = *this / b; }

  friend constexpr bool operator==(const Dual2& a, const Dual2& b) { return a.v == b.v; }
  friend constexpr std::partial_ordering operator<=>(const Dual2& a, const Dual2& b) { return a.v <=> b.v; }

  /// From f^2 = a: 2 f f' = a', 2 f f'' + 2 f'^2 = a''
  friend Dual2 sqrt(const Dual2& a) {
    const double f = std::sqrt(a.v);
    const double fd = a.d / (2.0 * f);
    return {f, fd, (a.dd - 2.0 * fd * fd) / (2.0 * f)};
  }

  friend Dual2 sin(const Dual2& a) {
    const double s = std::sin(a.v), c = std::cos(a.v);
    return {s, c * a.d, c * a.dd - s * a.d * a.d};
  }

  friend Dual2 cos(const Dual2& a) {
    const double s = std::sin(a.v), c = std::cos(a.v);
    return {c, -s * a.d, -s * a.dd - c * a.d * a.d};
  }

  /// n f' = x y' - y x' with n = x^2 + y^2, hence n f'' = x y'' - y x'' - n' f'
  friend Dual2 atan2(const Dual2& y, const Dual2& x) {
    const double n = x.v * x.v + y.v * y.v;
    const double fd = (x.v * y.d - y.v * x.d) / n;
    return {std::atan2(y.v, x.v), fd, (x.v * y.dd - y.v * x.dd - 2.0 * (x.v * x.d + y.v * y.d) * fd) / n};
  }
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(const T& f, const Vec3& a) { return {f * a.x, f * a.y, f * a.z}; }
};

template <class T>
T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Scalar first. Not necessarily of unit length.
template <class T>
struct Quat {
  T w{}, x{}, y{}, z{};

  friend Quat operator+(const Quat& a, const Quat& b) { return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Quat operator-(const Quat& a, const Quat& b) { return {a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Quat operator*(const T& f, const Quat& a) { return {f * a.w, f * a.x, f * a.y, f * a.z}; }

  /// (1.1) a b = (a0 b0 - av.bv, a0 bv + b0 av + av x bv)
  friend Quat operator*(const Quat& a, const Quat& b) {
    const Vec3<T> av{a.x, a.y, a.z}, bv{b.x, b.y, b.z};
    const Vec3<T> v = a.w * bv + b.w * av + cross(av, bv);
    return {a.w * b.w - dot(av, bv), v.x, v.y, v.z};
  }
};

/// The pure quaternion (0, a).
template <class T>
Quat<T> pure(const Vec3<T>& a) {
  return {T(0.0), a.x, a.y, a.z};
}

/// (1.2) q' = (q0, -qv)
template <class T>
Quat<T> conjugate(const Quat<T>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

template <class T>
Quat<T> normalised(const Quat<T>& q) {
  using std::sqrt;
  return T(1.0) / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z) * q;
}

template <class T>
struct Mat3 {
  Vec3<T> row1, row2, row3;
};

template <class T>
Vec3<T> operator*(const Mat3<T>& m, const Vec3<T>& a) {
  return {dot(m.row1, a), dot(m.row2, a), dot(m.row3, a)};
}

template <class T>
Mat3<T> transposed(const Mat3<T>& m) {
  return {{m.row1.x, m.row2.x, m.row3.x}, {m.row1.y, m.row2.y, m.row3.y}, {m.row1.z, m.row2.z, m.row3.z}};
}

/// (1.5) A(q), the axes of the moved frame -> the axes of its parent; orthogonal only for |q| = 1.
template <class T>
Mat3<T> rotation(const Quat<T>& q) {
  const T one(1.0), two(2.0);
  return {{two * (q.w * q.w + q.x * q.x) - one, two * (q.x * q.y - q.w * q.z), two * (q.x * q.z + q.w * q.y)},
          {two * (q.x * q.y + q.w * q.z), two * (q.w * q.w + q.y * q.y) - one, two * (q.y * q.z - q.w * q.x)},
          {two * (q.x * q.z - q.w * q.y), two * (q.y * q.z + q.w * q.x), two * (q.w * q.w + q.z * q.z) - one}};
}

}  // namespace lockstep::oracle
