// Jet: a number that carries exact derivatives. No finite differences anywhere in lockstep: what has no hand-written
// derivative is evaluated on jets.
//
// Jet<N> holds, of a function f of N variables y that move as y(t):
//   v  value             d  first derivative along the motion, f' = f_y yd (+ f_t)
//   g  gradient f_y, N   h  second derivative along the motion with ydd = 0: yd' f_yy yd (+ 2 f_yt yd + f_tt)
// Jet<0> is the plain "value, first and second derivative in time" of a law.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace lockstep {

template <int N, class T = double>
struct Jet {
  T v{0}, d{0}, h{0};
  Eigen::Matrix<T, N, 1> g = Eigen::Matrix<T, N, 1>::Zero();

  Jet() = default;
  Jet(double value) : v(value) {}  // NOLINT: a constant is a jet
  Jet(const T& value, const T& first, const T& second) : v(value), d(first), h(second) {}

  /// Variable k of N, moving at the rate `first`.
  static Jet variable(int k, const T& value, const T& first, const T& second = T(0)) {
    Jet a(value, first, second);
    a.g[k] = T(1);
    return a;
  }
};

namespace jet_detail {
/// f(a) by the chain rule: f0, f1, f2 are f, f', f'' at a.v.
template <int N, class T>
inline Jet<N, T> chain(const Jet<N, T>& a, const T& f0, const T& f1, const T& f2) {
  Jet<N, T> r;
  r.v = f0;
  r.d = f1 * a.d;
  r.h = f1 * a.h + f2 * a.d * a.d;
  r.g = f1 * a.g;
  return r;
}
}  // namespace jet_detail

template <int N, class T>
inline Jet<N, T> operator+(Jet<N, T> a, const Jet<N, T>& b) {
  a.v += b.v, a.d += b.d, a.h += b.h, a.g += b.g;
  return a;
}
template <int N, class T>
inline Jet<N, T> operator-(Jet<N, T> a, const Jet<N, T>& b) {
  a.v -= b.v, a.d -= b.d, a.h -= b.h, a.g -= b.g;
  return a;
}
template <int N, class T>
inline Jet<N, T> operator-(const Jet<N, T>& a) {
  Jet<N, T> r;
  r.v = -a.v, r.d = -a.d, r.h = -a.h, r.g = -a.g;
  return r;
}
template <int N, class T>
inline Jet<N, T> operator*(const Jet<N, T>& a, const Jet<N, T>& b) {
  Jet<N, T> r;
  r.v = a.v * b.v;
  r.d = a.d * b.v + a.v * b.d;
  r.h = a.h * b.v + T(2) * a.d * b.d + a.v * b.h;
  r.g = a.g * b.v + a.v * b.g;
  return r;
}
template <int N, class T>
inline Jet<N, T> inverse(const Jet<N, T>& a) {
  const T i = T(1) / a.v;
  return jet_detail::chain(a, i, T(-i * i), T(T(2) * i * i * i));
}
template <int N, class T>
inline Jet<N, T> operator/(const Jet<N, T>& a, const Jet<N, T>& b) {
  return a * inverse(b);
}

template <int N, class T>
inline Jet<N, T> operator+(Jet<N, T> a, double b) {
  return a.v += b, a;
}
template <int N, class T>
inline Jet<N, T> operator+(double b, Jet<N, T> a) {
  return a.v += b, a;
}
template <int N, class T>
inline Jet<N, T> operator-(Jet<N, T> a, double b) {
  return a.v -= b, a;
}
template <int N, class T>
inline Jet<N, T> operator-(double b, const Jet<N, T>& a) {
  return -a + b;
}
template <int N, class T>
inline Jet<N, T> operator*(Jet<N, T> a, double b) {
  a.v *= b, a.d *= b, a.h *= b, a.g *= b;
  return a;
}
template <int N, class T>
inline Jet<N, T> operator*(double b, Jet<N, T> a) {
  return a * b;
}
template <int N, class T>
inline Jet<N, T> operator/(const Jet<N, T>& a, double b) {
  return a * (1.0 / b);
}
template <int N, class T>
inline Jet<N, T> operator/(double b, const Jet<N, T>& a) {
  return inverse(a) * b;
}
template <int N, class T>
inline Jet<N, T>& operator+=(Jet<N, T>& a, const Jet<N, T>& b) {
  return a = a + b;
}
template <int N, class T>
inline Jet<N, T>& operator-=(Jet<N, T>& a, const Jet<N, T>& b) {
  return a = a - b;
}
template <int N, class T>
inline Jet<N, T>& operator*=(Jet<N, T>& a, const Jet<N, T>& b) {
  return a = a * b;
}
template <int N, class T>
inline Jet<N, T>& operator/=(Jet<N, T>& a, const Jet<N, T>& b) {
  return a = a / b;
}

template <int N, class T>
inline bool operator<(const Jet<N, T>& a, const Jet<N, T>& b) {
  return a.v < b.v;
}
template <int N, class T>
inline bool operator>(const Jet<N, T>& a, const Jet<N, T>& b) {
  return a.v > b.v;
}
template <int N, class T>
inline bool operator<(const Jet<N, T>& a, double b) {
  return a.v < b;
}
template <int N, class T>
inline bool operator>(const Jet<N, T>& a, double b) {
  return a.v > b;
}
template <int N, class T>
inline bool operator<=(const Jet<N, T>& a, double b) {
  return a.v <= b;
}
template <int N, class T>
inline bool operator>=(const Jet<N, T>& a, double b) {
  return a.v >= b;
}

template <int N, class T>
inline Jet<N, T> sqrt(const Jet<N, T>& a) {
  using std::sqrt;
  const T s = sqrt(a.v), f1 = T(0.5) / s;
  return jet_detail::chain(a, s, f1, T(-f1 / (T(2) * a.v)));
}
template <int N, class T>
inline Jet<N, T> sin(const Jet<N, T>& a) {
  using std::cos, std::sin;
  const T s = sin(a.v), c = cos(a.v);
  return jet_detail::chain(a, s, c, T(-s));
}
template <int N, class T>
inline Jet<N, T> cos(const Jet<N, T>& a) {
  using std::cos, std::sin;
  const T s = sin(a.v), c = cos(a.v);
  return jet_detail::chain(a, c, T(-s), T(-c));
}
template <int N, class T>
inline Jet<N, T> tan(const Jet<N, T>& a) {
  return sin(a) / cos(a);
}
template <int N, class T>
inline Jet<N, T> exp(const Jet<N, T>& a) {
  using std::exp;
  const T e = exp(a.v);
  return jet_detail::chain(a, e, e, e);
}
template <int N, class T>
inline Jet<N, T> log(const Jet<N, T>& a) {
  using std::log;
  const T i = T(1) / a.v;
  return jet_detail::chain(a, T(log(a.v)), i, T(-i * i));
}
template <int N, class T>
inline Jet<N, T> pow(const Jet<N, T>& a, double p) {
  using std::pow;
  return jet_detail::chain(a, T(pow(a.v, p)), T(p * pow(a.v, p - 1)), T(p * (p - 1) * pow(a.v, p - 2)));
}
template <int N, class T>
inline Jet<N, T> sinh(const Jet<N, T>& a) {
  return 0.5 * (exp(a) - exp(-a));
}
template <int N, class T>
inline Jet<N, T> cosh(const Jet<N, T>& a) {
  return 0.5 * (exp(a) + exp(-a));
}
template <int N, class T>
inline Jet<N, T> tanh(const Jet<N, T>& a) {
  using std::tanh;
  const T y = tanh(a.v), f1 = T(1) - y * y;
  return jet_detail::chain(a, y, f1, T(T(-2) * y * f1));
}
template <int N, class T>
inline Jet<N, T> abs(const Jet<N, T>& a) {
  return a.v < 0 ? -a : a;
}
template <int N, class T>
inline Jet<N, T> atan(const Jet<N, T>& a) {
  using std::atan;
  const T f1 = T(1) / (T(1) + a.v * a.v);
  return jet_detail::chain(a, T(atan(a.v)), f1, T(T(-2) * a.v * f1 * f1));
}
/// atan2(y, x); its derivatives are those of the angle, whatever the branch:
///
///   f_y = x/n, f_x = -y/n, n = x^2 + y^2         f_yy = -2 x y/n^2 = -f_xx,  f_xy = (y^2 - x^2)/n^2
template <int N, class T>
inline Jet<N, T> atan2(const Jet<N, T>& y, const Jet<N, T>& x) {
  using std::atan2;
  const T i = T(1) / (x.v * x.v + y.v * y.v), fy = x.v * i, fx = -y.v * i;
  Jet<N, T> r;
  r.v = atan2(y.v, x.v);
  r.d = fy * y.d + fx * x.d;
  // yd and xd by their parts along and across (x, y): (-2 xy (yd^2 - xd^2) + 2 (y^2 - x^2) xd yd)/n^2
  r.h = fy * y.h + fx * x.h - T(2) * r.d * (fy * x.d - fx * y.d);
  r.g = fy * y.g + fx * x.g;
  return r;
}
template <int N, class T>
inline Jet<N, T> asin(const Jet<N, T>& a) {
  return atan2(a, sqrt(1.0 - a * a));
}
template <int N, class T>
inline Jet<N, T> acos(const Jet<N, T>& a) {
  return atan2(sqrt(1.0 - a * a), a);
}

/// Time of a law: value t, rate 1.
using Time = Jet<0>;

}  // namespace lockstep
