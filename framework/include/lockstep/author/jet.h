// SPDX-License-Identifier: BSD-3-Clause
// Numbers that carry their derivatives: automatic differentiation in forward mode.
#pragma once

#include <cmath>
#include <compare>
#include <concepts>
#include <cstddef>
#include <iosfwd>
#include <type_traits>

#include <Eigen/Core>

namespace lockstep {

// Rows and laws use no finite differences: a derivative that is not written by hand is evaluated on jets. Only the
// default tangents of joints and forces, which implicit integrators use, are differences.
//
// Jet<N> holds, of a function f of N variables y that move as y(t):
//   v  value             d  first derivative along the motion, f' = f_y yd (+ f_t)
//   g  gradient f_y, N   h  second derivative along the motion with ydd = 0: yd' f_yy yd (+ 2 f_yt yd + f_tt)
// Jet<0> is value, first and second time derivative: the number of a law.

/// In place of the derivatives along the motion, in a jet of which only the gradient is wanted: stores and computes
/// nothing.
struct NoMotion {
  NoMotion() = default;
  /// A derivative that is a constant: nothing.
  explicit NoMotion(int) {}
  NoMotion operator-() const { return {}; }                     ///< nothing
  NoMotion& operator+=(NoMotion) { return *this; }              ///< nothing
  NoMotion& operator-=(NoMotion) { return *this; }              ///< nothing
  NoMotion& operator*=(double) { return *this; }                ///< nothing
  friend NoMotion operator+(NoMotion, NoMotion) { return {}; }  ///< nothing
  friend NoMotion operator-(NoMotion, NoMotion) { return {}; }  ///< nothing
  friend NoMotion operator*(NoMotion, NoMotion) { return {}; }  ///< nothing
  friend NoMotion operator*(NoMotion, double) { return {}; }    ///< nothing
  friend NoMotion operator*(double, NoMotion) { return {}; }    ///< nothing
};

namespace jet_detail {
/// What a jet may be combined with. A jet is no such number.
template <class B>
concept Number = std::convertible_to<B, double>;

// Once for all jets: one error.
template <class F>
F not_a_number() {
  static_assert(
      !std::same_as<F, long double>,
      "functions of std know no jets: write sin(x), not std::sin(x), for lockstep's sqrt, sin, cos, tan, exp, "
      "log, pow, sinh, cosh, tanh, abs, atan, atan2, asin, acos, max and min; value_of(x) is the number alone");
  return {};
}
}  // namespace jet_detail

/// A number with its exact derivatives: N components of a gradient, and two derivatives along a motion. T: number type;
/// D: type of the derivatives along the motion, T or NoMotion.
template <int N, class T = double, class D = T>
struct Jet {
  T v{0};                                                     ///< value
  [[no_unique_address]] D d{0};                               ///< first derivative along the motion
  [[no_unique_address]] D h{0};                               ///< second derivative along the motion, with ydd = 0
  Eigen::Matrix<T, N, 1> g = Eigen::Matrix<T, N, 1>::Zero();  ///< gradient, N

  Jet() = default;
  /// A constant: all derivatives are zero.
  Jet(double value) : v(value) {}  // NOLINT: a constant is a jet
  /// A function of time: value and its two derivatives along the motion; the gradient is zero.
  Jet(const T& value, const D& first, const D& second) : v(value), d(first), h(second) {}

  /// Variable k of N, 0 <= k < N: gradient e_k, rate `first`, second derivative `second` along the motion.
  static Jet variable(int k, const T& value, const D& first, const D& second = D(0)) {
    Jet a(value, first, second);
    a.g[k] = T(1);
    return a;
  }

  /// A jet is not a number. Functions of std take only numbers, and of those this one alone: their call ends here.
  template <std::same_as<long double> F>
  operator F() const {
    return jet_detail::not_a_number<F>();
  }
};

namespace jet_detail {
/// f(a) by the chain rule: f0, f1, f2 are f, f', f'' at a.v.
template <int N, class T, class D>
inline Jet<N, T, D> chain(const Jet<N, T, D>& a, const T& f0, const T& f1, const T& f2) {
  Jet<N, T, D> r;
  r.v = f0;
  r.d = f1 * a.d;
  r.h = f1 * a.h + f2 * a.d * a.d;
  r.g = f1 * a.g;
  return r;
}

double value_of(Number auto a) { return double(a); }
template <int N, class T, class D>
const T& value_of(const Jet<N, T, D>& a) {
  return a.v;
}
template <class A, class B>
inline constexpr bool is_pair = false;
template <int N, class T, class D>
inline constexpr bool is_pair<Jet<N, T, D>, Jet<N, T, D>> = true;
template <int N, class T, class D, Number B>
inline constexpr bool is_pair<Jet<N, T, D>, B> = true;
template <Number A, int N, class T, class D>
inline constexpr bool is_pair<A, Jet<N, T, D>> = true;
/// Two jets, or a jet and a number.
template <class A, class B>
concept Pair = is_pair<A, B>;
/// The type of a jet of both.
template <class A, class B>
using JetOf = std::conditional_t<is_pair<A, A>, A, B>;
}  // namespace jet_detail

/// a + b
template <int N, class T, class D>
inline Jet<N, T, D> operator+(Jet<N, T, D> a, const Jet<N, T, D>& b) {
  a.v += b.v, a.d += b.d, a.h += b.h, a.g += b.g;
  return a;
}
/// a - b
template <int N, class T, class D>
inline Jet<N, T, D> operator-(Jet<N, T, D> a, const Jet<N, T, D>& b) {
  a.v -= b.v, a.d -= b.d, a.h -= b.h, a.g -= b.g;
  return a;
}
/// -a
template <int N, class T, class D>
inline Jet<N, T, D> operator-(const Jet<N, T, D>& a) {
  Jet<N, T, D> r;
  r.v = -a.v, r.d = -a.d, r.h = -a.h, r.g = -a.g;
  return r;
}
/// a b, with (a b)'' = a'' b + 2 a' b' + a b''
template <int N, class T, class D>
inline Jet<N, T, D> operator*(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  Jet<N, T, D> r;
  r.v = a.v * b.v;
  r.d = a.d * b.v + a.v * b.d;
  r.h = a.h * b.v + T(2) * a.d * b.d + a.v * b.h;
  r.g = a.g * b.v + a.v * b.g;
  return r;
}
/// 1/a; a must not be zero.
template <int N, class T, class D>
inline Jet<N, T, D> inverse(const Jet<N, T, D>& a) {
  const T i = T(1) / a.v;
  return jet_detail::chain(a, i, T(-i * i), T(T(2) * i * i * i));
}
/// a/b; b must not be zero.
template <int N, class T, class D>
inline Jet<N, T, D> operator/(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  return a * inverse(b);
}

/// a + b
template <int N, class T, class D>
inline Jet<N, T, D> operator+(Jet<N, T, D> a, const jet_detail::Number auto& b) {
  return a.v += double(b), a;
}
/// a + b
template <int N, class T, class D>
inline Jet<N, T, D> operator+(const jet_detail::Number auto& b, Jet<N, T, D> a) {
  return a.v += double(b), a;
}
/// a - b
template <int N, class T, class D>
inline Jet<N, T, D> operator-(Jet<N, T, D> a, const jet_detail::Number auto& b) {
  return a.v -= double(b), a;
}
/// b - a
template <int N, class T, class D>
inline Jet<N, T, D> operator-(const jet_detail::Number auto& b, const Jet<N, T, D>& a) {
  return -a + b;
}
/// a b
template <int N, class T, class D>
inline Jet<N, T, D> operator*(Jet<N, T, D> a, const jet_detail::Number auto& b) {
  const double k = double(b);
  a.v *= k, a.d *= k, a.h *= k, a.g *= k;
  return a;
}
/// b a
template <int N, class T, class D>
inline Jet<N, T, D> operator*(const jet_detail::Number auto& b, Jet<N, T, D> a) {
  return a * b;
}
/// a/b; b must not be zero.
template <int N, class T, class D>
inline Jet<N, T, D> operator/(const Jet<N, T, D>& a, const jet_detail::Number auto& b) {
  return a * (1.0 / double(b));
}
/// b/a; a must not be zero.
template <int N, class T, class D>
inline Jet<N, T, D> operator/(const jet_detail::Number auto& b, const Jet<N, T, D>& a) {
  return inverse(a) * b;
}
/// a = a + b, b a jet or a number
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator+=(Jet<N, T, D>& a, const B& b) {
  return a = a + b;
}
/// a = a - b, b a jet or a number
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator-=(Jet<N, T, D>& a, const B& b) {
  return a = a - b;
}
/// a = a b, b a jet or a number
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator*=(Jet<N, T, D>& a, const B& b) {
  return a = a * b;
}
/// a = a/b, b a jet or a number
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator/=(Jet<N, T, D>& a, const B& b) {
  return a = a / b;
}

/// Compares the values only, as all comparisons of jets do: with jets and with numbers.
template <class A, class B>
requires jet_detail::Pair<A, B>
inline std::partial_ordering operator<=>(const A& a, const B& b) {
  return jet_detail::value_of(a) <=> jet_detail::value_of(b);
}
/// Compares the values.
template <class A, class B>
requires jet_detail::Pair<A, B>
inline bool operator==(const A& a, const B& b) { return jet_detail::value_of(a) == jet_detail::value_of(b); }

/// Square root; its derivatives are infinite at a = 0.
template <int N, class T, class D>
inline Jet<N, T, D> sqrt(const Jet<N, T, D>& a) {
  using std::sqrt;
  const T s = sqrt(a.v), f1 = T(0.5) / s;
  return jet_detail::chain(a, s, f1, T(-f1 / (T(2) * a.v)));
}
/// Sine of a, rad.
template <int N, class T, class D>
inline Jet<N, T, D> sin(const Jet<N, T, D>& a) {
  using std::cos, std::sin;
  const T s = sin(a.v), c = cos(a.v);
  return jet_detail::chain(a, s, c, T(-s));
}
/// Cosine of a, rad.
template <int N, class T, class D>
inline Jet<N, T, D> cos(const Jet<N, T, D>& a) {
  using std::cos, std::sin;
  const T s = sin(a.v), c = cos(a.v);
  return jet_detail::chain(a, c, T(-s), T(-c));
}
/// Tangent of a, rad.
template <int N, class T, class D>
inline Jet<N, T, D> tan(const Jet<N, T, D>& a) {
  return sin(a) / cos(a);
}
/// e^a
template <int N, class T, class D>
inline Jet<N, T, D> exp(const Jet<N, T, D>& a) {
  using std::exp;
  const T e = exp(a.v);
  return jet_detail::chain(a, e, e, e);
}
/// Natural logarithm, a > 0.
template <int N, class T, class D>
inline Jet<N, T, D> log(const Jet<N, T, D>& a) {
  using std::log;
  const T i = T(1) / a.v;
  return jet_detail::chain(a, T(log(a.v)), i, T(-i * i));
}
/// a^p with a constant exponent; a > 0, or a not 0 when p is whole.
template <int N, class T, class D>
inline Jet<N, T, D> pow(const Jet<N, T, D>& a, double p) {
  using std::pow;
  return jet_detail::chain(a, T(pow(a.v, p)), T(p * pow(a.v, p - 1)), T(p * (p - 1) * pow(a.v, p - 2)));
}
/// Hyperbolic sine.
template <int N, class T, class D>
inline Jet<N, T, D> sinh(const Jet<N, T, D>& a) {
  return 0.5 * (exp(a) - exp(-a));
}
/// Hyperbolic cosine.
template <int N, class T, class D>
inline Jet<N, T, D> cosh(const Jet<N, T, D>& a) {
  return 0.5 * (exp(a) + exp(-a));
}
/// Hyperbolic tangent.
template <int N, class T, class D>
inline Jet<N, T, D> tanh(const Jet<N, T, D>& a) {
  using std::tanh;
  const T y = tanh(a.v), f1 = T(1) - y * y;
  return jet_detail::chain(a, y, f1, T(T(-2) * y * f1));
}
/// |a|, with the derivatives from the right at a = 0.
template <int N, class T, class D>
inline Jet<N, T, D> abs(const Jet<N, T, D>& a) {
  return a.v < 0 ? -a : a;
}
/// The greater of two jets, with its derivatives; a if both are equal. Preferred to std::max.
template <int N, class T, class D>
inline Jet<N, T, D> max(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  return a < b ? b : a;
}
/// The same of a jet and a number.
template <class A, class B>
requires jet_detail::Pair<A, B>
inline jet_detail::JetOf<A, B> max(const A& a, const B& b) { return a < b ? b : a; }
/// The smaller of two jets, with its derivatives; a if both are equal. Preferred to std::min.
template <int N, class T, class D>
inline Jet<N, T, D> min(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  return b < a ? b : a;
}
/// The same of a jet and a number.
template <class A, class B>
requires jet_detail::Pair<A, B>
inline jet_detail::JetOf<A, B> min(const A& a, const B& b) { return b < a ? b : a; }
/// Arc tangent, rad.
template <int N, class T, class D>
inline Jet<N, T, D> atan(const Jet<N, T, D>& a) {
  using std::atan;
  const T f1 = T(1) / (T(1) + a.v * a.v);
  return jet_detail::chain(a, T(atan(a.v)), f1, T(T(-2) * a.v * f1 * f1));
}
/// Angle of the point (x, y), rad, in [-pi, pi]; its derivatives are those of the angle, on every branch:
///
///   f_y = x/n, f_x = -y/n, n = x^2 + y^2         f_yy = -2 x y/n^2 = -f_xx,  f_xy = (y^2 - x^2)/n^2
template <int N, class T, class D>
inline Jet<N, T, D> atan2(const Jet<N, T, D>& y, const Jet<N, T, D>& x) {
  using std::atan2;
  const T i = T(1) / (x.v * x.v + y.v * y.v), fy = x.v * i, fx = -y.v * i;
  Jet<N, T, D> r;
  r.v = atan2(y.v, x.v);
  r.d = fy * y.d + fx * x.d;
  // yd and xd by their parts along and across (x, y): (-2 xy (yd^2 - xd^2) + 2 (y^2 - x^2) xd yd)/n^2
  r.h = fy * y.h + fx * x.h - T(2) * r.d * (fy * x.d - fx * y.d);
  r.g = fy * y.g + fx * x.g;
  return r;
}
/// Arc sine, rad; |a| < 1.
template <int N, class T, class D>
inline Jet<N, T, D> asin(const Jet<N, T, D>& a) {
  return atan2(a, sqrt(1.0 - a * a));
}
/// Arc cosine, rad; |a| < 1.
template <int N, class T, class D>
inline Jet<N, T, D> acos(const Jet<N, T, D>& a) {
  return atan2(sqrt(1.0 - a * a), a);
}

/// Writes the value.
template <int N, class T, class D>
inline std::ostream& operator<<(std::ostream& out, const Jet<N, T, D>& a) {
  return out << a.v;
}

/// The number itself: value_of() of what may be a jet or a number.
inline double value_of(double a) { return a; }
/// The value without its derivatives, for what is decided once and does not vary: a branch, the number of revolutions.
template <int N, class T, class D>
inline T value_of(const Jet<N, T, D>& a) {
  return a.v;
}

/// |a|, of numbers or jets. The gradient at a = 0 is zero, so that |a| a and other functions that are flat there have
/// their derivatives.
template <class A>
inline typename A::Scalar norm(const Eigen::MatrixBase<A>& a) {
  using std::sqrt;
  const typename A::Scalar square = a.dot(a);
  return square <= 0 ? square : typename A::Scalar(sqrt(square));
}

/// Time as the argument of a law: value t, rate 1.
using Time = Jet<0>;

}  // namespace lockstep

/// The type of a jet combined with a number in Eigen's expressions: jets.
template <int N, class D, class Op>
struct Eigen::ScalarBinaryOpTraits<lockstep::Jet<N, double, D>, double, Op> {
  using ReturnType = lockstep::Jet<N, double, D>;  ///< a jet
};
/// The type of a number combined with a jet in Eigen's expressions: jets.
template <int N, class D, class Op>
struct Eigen::ScalarBinaryOpTraits<double, lockstep::Jet<N, double, D>, Op> {
  using ReturnType = lockstep::Jet<N, double, D>;  ///< a jet
};

namespace lockstep {

// Pack<N>: N doubles that the compiler keeps in vector registers of any instruction set.
//
// A block of up to 8 rows has one pack per column, so that one instruction works on all rows of a joint.

/// The type of a pack of N numbers: N is 2, 4 or 8.
template <int N>
struct PackOf {
  static_assert(N == 2 || N == 4 || N == 8, "a pack has 2, 4 or 8 numbers");
  typedef double scalar __attribute__((may_alias));  ///< which the pack takes over; one that depends on N is ignored
  typedef scalar type __attribute__((vector_size(8 * N)));  ///< 8 N bytes
};
/// N doubles in vector registers, N = 2, 4 or 8; arithmetic is element by element.
template <int N>
using Pack = typename PackOf<N>::type;

/// Length of the smallest pack that holds m numbers, m <= 8: 2, 4 or 8.
constexpr int pack_size(int m) { return m <= 2 ? 2 : m <= 4 ? 4 : 8; }
/// The first multiple of n at or after `at`: the next offset at which a pack of n numbers is aligned.
constexpr std::size_t aligned_to(std::size_t at, int n) {
  const auto k = static_cast<std::size_t>(n);
  return (at + k - 1) / k * k;
}
inline constexpr std::size_t kPackAlignment = 64;  ///< alignment of every array that packs are read from, bytes

}  // namespace lockstep
