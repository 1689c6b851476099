// Numbers that carry their derivatives: automatic differentiation in forward mode.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace lockstep {

// Jet: a number that carries exact derivatives. No finite differences anywhere in lockstep: what has no hand-written
// derivative is evaluated on jets.
//
// Jet<N> holds, of a function f of N variables y that move as y(t):
//   v  value             d  first derivative along the motion, f' = f_y yd (+ f_t)
//   g  gradient f_y, N   h  second derivative along the motion with ydd = 0: yd' f_yy yd (+ 2 f_yt yd + f_tt)
// Jet<0> is the plain "value, first and second derivative in time" of a law.


/// Takes the place of the derivatives along the motion in a jet that needs its gradient alone: nothing is stored and
/// nothing computed.
struct NoMotion {
  NoMotion() = default;
  explicit NoMotion(int) {}
  NoMotion operator-() const { return {}; }
  NoMotion& operator+=(NoMotion) { return *this; }
  NoMotion& operator-=(NoMotion) { return *this; }
  NoMotion& operator*=(double) { return *this; }
  friend NoMotion operator+(NoMotion, NoMotion) { return {}; }
  friend NoMotion operator-(NoMotion, NoMotion) { return {}; }
  friend NoMotion operator*(NoMotion, NoMotion) { return {}; }
  friend NoMotion operator*(NoMotion, double) { return {}; }
  friend NoMotion operator*(double, NoMotion) { return {}; }
};

/// D: the type of the derivatives along the motion, T or NoMotion.
template <int N, class T = double, class D = T>
struct Jet {
  T v{0};
  [[no_unique_address]] D d{0};
  [[no_unique_address]] D h{0};
  Eigen::Matrix<T, N, 1> g = Eigen::Matrix<T, N, 1>::Zero();

  Jet() = default;
  Jet(double value) : v(value) {}  // NOLINT: a constant is a jet
  Jet(const T& value, const D& first, const D& second) : v(value), d(first), h(second) {}

  /// Variable k of N, moving at the rate `first`.
  static Jet variable(int k, const T& value, const D& first, const D& second = D(0)) {
    Jet a(value, first, second);
    a.g[k] = T(1);
    return a;
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
}  // namespace jet_detail

template <int N, class T, class D>
inline Jet<N, T, D> operator+(Jet<N, T, D> a, const Jet<N, T, D>& b) {
  a.v += b.v, a.d += b.d, a.h += b.h, a.g += b.g;
  return a;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator-(Jet<N, T, D> a, const Jet<N, T, D>& b) {
  a.v -= b.v, a.d -= b.d, a.h -= b.h, a.g -= b.g;
  return a;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator-(const Jet<N, T, D>& a) {
  Jet<N, T, D> r;
  r.v = -a.v, r.d = -a.d, r.h = -a.h, r.g = -a.g;
  return r;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator*(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  Jet<N, T, D> r;
  r.v = a.v * b.v;
  r.d = a.d * b.v + a.v * b.d;
  r.h = a.h * b.v + T(2) * a.d * b.d + a.v * b.h;
  r.g = a.g * b.v + a.v * b.g;
  return r;
}
template <int N, class T, class D>
inline Jet<N, T, D> inverse(const Jet<N, T, D>& a) {
  const T i = T(1) / a.v;
  return jet_detail::chain(a, i, T(-i * i), T(T(2) * i * i * i));
}
template <int N, class T, class D>
inline Jet<N, T, D> operator/(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  return a * inverse(b);
}

template <int N, class T, class D>
inline Jet<N, T, D> operator+(Jet<N, T, D> a, double b) {
  return a.v += b, a;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator+(double b, Jet<N, T, D> a) {
  return a.v += b, a;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator-(Jet<N, T, D> a, double b) {
  return a.v -= b, a;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator-(double b, const Jet<N, T, D>& a) {
  return -a + b;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator*(Jet<N, T, D> a, double b) {
  a.v *= b, a.d *= b, a.h *= b, a.g *= b;
  return a;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator*(double b, Jet<N, T, D> a) {
  return a * b;
}
template <int N, class T, class D>
inline Jet<N, T, D> operator/(const Jet<N, T, D>& a, double b) {
  return a * (1.0 / b);
}
template <int N, class T, class D>
inline Jet<N, T, D> operator/(double b, const Jet<N, T, D>& a) {
  return inverse(a) * b;
}
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator+=(Jet<N, T, D>& a, const B& b) {
  return a = a + b;
}
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator-=(Jet<N, T, D>& a, const B& b) {
  return a = a - b;
}
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator*=(Jet<N, T, D>& a, const B& b) {
  return a = a * b;
}
template <int N, class T, class D, class B>
inline Jet<N, T, D>& operator/=(Jet<N, T, D>& a, const B& b) {
  return a = a / b;
}

template <int N, class T, class D>
inline bool operator<(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  return a.v < b.v;
}
template <int N, class T, class D>
inline bool operator>(const Jet<N, T, D>& a, const Jet<N, T, D>& b) {
  return a.v > b.v;
}
template <int N, class T, class D>
inline bool operator<(const Jet<N, T, D>& a, double b) {
  return a.v < b;
}
template <int N, class T, class D>
inline bool operator>(const Jet<N, T, D>& a, double b) {
  return a.v > b;
}
template <int N, class T, class D>
inline bool operator<=(const Jet<N, T, D>& a, double b) {
  return a.v <= b;
}
template <int N, class T, class D>
inline bool operator>=(const Jet<N, T, D>& a, double b) {
  return a.v >= b;
}

template <int N, class T, class D>
inline Jet<N, T, D> sqrt(const Jet<N, T, D>& a) {
  using std::sqrt;
  const T s = sqrt(a.v), f1 = T(0.5) / s;
  return jet_detail::chain(a, s, f1, T(-f1 / (T(2) * a.v)));
}
template <int N, class T, class D>
inline Jet<N, T, D> sin(const Jet<N, T, D>& a) {
  using std::cos, std::sin;
  const T s = sin(a.v), c = cos(a.v);
  return jet_detail::chain(a, s, c, T(-s));
}
template <int N, class T, class D>
inline Jet<N, T, D> cos(const Jet<N, T, D>& a) {
  using std::cos, std::sin;
  const T s = sin(a.v), c = cos(a.v);
  return jet_detail::chain(a, c, T(-s), T(-c));
}
template <int N, class T, class D>
inline Jet<N, T, D> tan(const Jet<N, T, D>& a) {
  return sin(a) / cos(a);
}
template <int N, class T, class D>
inline Jet<N, T, D> exp(const Jet<N, T, D>& a) {
  using std::exp;
  const T e = exp(a.v);
  return jet_detail::chain(a, e, e, e);
}
template <int N, class T, class D>
inline Jet<N, T, D> log(const Jet<N, T, D>& a) {
  using std::log;
  const T i = T(1) / a.v;
  return jet_detail::chain(a, T(log(a.v)), i, T(-i * i));
}
template <int N, class T, class D>
inline Jet<N, T, D> pow(const Jet<N, T, D>& a, double p) {
  using std::pow;
  return jet_detail::chain(a, T(pow(a.v, p)), T(p * pow(a.v, p - 1)), T(p * (p - 1) * pow(a.v, p - 2)));
}
template <int N, class T, class D>
inline Jet<N, T, D> sinh(const Jet<N, T, D>& a) {
  return 0.5 * (exp(a) - exp(-a));
}
template <int N, class T, class D>
inline Jet<N, T, D> cosh(const Jet<N, T, D>& a) {
  return 0.5 * (exp(a) + exp(-a));
}
template <int N, class T, class D>
inline Jet<N, T, D> tanh(const Jet<N, T, D>& a) {
  using std::tanh;
  const T y = tanh(a.v), f1 = T(1) - y * y;
  return jet_detail::chain(a, y, f1, T(T(-2) * y * f1));
}
template <int N, class T, class D>
inline Jet<N, T, D> abs(const Jet<N, T, D>& a) {
  return a.v < 0 ? -a : a;
}
template <int N, class T, class D>
inline Jet<N, T, D> atan(const Jet<N, T, D>& a) {
  using std::atan;
  const T f1 = T(1) / (T(1) + a.v * a.v);
  return jet_detail::chain(a, T(atan(a.v)), f1, T(T(-2) * a.v * f1 * f1));
}
/// atan2(y, x); its derivatives are those of the angle, whatever the branch:
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
template <int N, class T, class D>
inline Jet<N, T, D> asin(const Jet<N, T, D>& a) {
  return atan2(a, sqrt(1.0 - a * a));
}
template <int N, class T, class D>
inline Jet<N, T, D> acos(const Jet<N, T, D>& a) {
  return atan2(sqrt(1.0 - a * a), a);
}

/// The value alone, for what is decided once and does not vary: a branch, the number of turns.
inline double value_of(double a) { return a; }
template <int N, class T, class D>
inline T value_of(const Jet<N, T, D>& a) {
  return a.v;
}

/// |a|, of numbers or jets. On jets its gradient is zero where a is, so that |a| a and all else that is flat there have
/// their derivatives.
template <class A>
inline typename A::Scalar norm(const Eigen::MatrixBase<A>& a) {
  using std::sqrt;
  const typename A::Scalar square = a.dot(a);
  return square <= 0 ? square : typename A::Scalar(sqrt(square));
}

/// Time of a law: value t, rate 1.
using Time = Jet<0>;

}  // namespace lockstep

/// Vectors of jets with vectors and factors of plain numbers.
template <int N, class D, class Op>
struct Eigen::ScalarBinaryOpTraits<lockstep::Jet<N, double, D>, double, Op> {
  using ReturnType = lockstep::Jet<N, double, D>;
};
/// A number times a jet is a jet.
template <int N, class D, class Op>
struct Eigen::ScalarBinaryOpTraits<double, lockstep::Jet<N, double, D>, Op> {
  using ReturnType = lockstep::Jet<N, double, D>;
};

namespace lockstep {

// Pack<N>: N doubles that the compiler keeps in vector registers, whatever the machine offers.
//
// A row block of up to 8 rows is a pack a column, so that one instruction serves all rows of a link.


template <int N>
struct PackOf;
/// Two numbers in one register.
template <>
struct PackOf<2> {
  typedef double type __attribute__((vector_size(16), may_alias));
};
/// Four numbers in one register.
template <>
struct PackOf<4> {
  typedef double type __attribute__((vector_size(32), may_alias));
};
/// Eight numbers in one register.
template <>
struct PackOf<8> {
  typedef double type __attribute__((vector_size(64), may_alias));
};
template <int N>
using Pack = typename PackOf<N>::type;

/// Numbers of a pack that holds m of them: 2, 4 or 8.
constexpr int pack_size(int m) { return m <= 2 ? 2 : m <= 4 ? 4 : 8; }
/// The next offset at or after `at` where a pack of n numbers may stand.
constexpr std::size_t aligned_to(std::size_t at, int n) {
  const auto k = static_cast<std::size_t>(n);
  return (at + k - 1) / k * k;
}
inline constexpr std::size_t kPackAlignment = 64;  ///< bytes, of every array that packs are read from

}  // namespace lockstep
