// SPDX-License-Identifier: BSD-3-Clause
// Intervals that hold all values of a formula over a span of its variables.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/math.h>

namespace lockstep::expression {

/// All numbers from lo to hi. Results of operations are widened by their round-off; what cannot be bounded is everything.
struct Interval {
  double lo = 0, hi = 0;
  Interval() = default;
  Interval(double x) : lo(x), hi(x) {}  // NOLINT: a constant is an interval
  Interval(double low, double high) : lo(low), hi(high) {}

  static Interval everything() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  bool holds(double x) const { return lo <= x && x <= hi; }
};

namespace interval_detail {
inline Interval widened(double lo, double hi) {
  if (std::isnan(lo) || std::isnan(hi)) return Interval::everything();
  constexpr double kPart = 4 * std::numeric_limits<double>::epsilon(), kLeast = std::numeric_limits<double>::min();
  return {lo - kPart * std::abs(lo) - kLeast, hi + kPart * std::abs(hi) + kLeast};
}
/// f of both ends, f rising.
inline Interval rising(const Interval& a, double (*f)(double)) { return widened(f(a.lo), f(a.hi)); }
}  // namespace interval_detail

inline Interval hull(const Interval& a, const Interval& b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return interval_detail::widened(a.lo + b.lo, a.hi + b.hi);
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return interval_detail::widened(a.lo - b.hi, a.hi - b.lo);
}
inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p[4] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
  for (const double x : p)
    if (std::isnan(x)) return Interval::everything();
  return interval_detail::widened(*std::min_element(p, p + 4), *std::max_element(p, p + 4));
}
inline Interval operator/(const Interval& a, const Interval& b) {
  if (b.holds(0)) return Interval::everything();
  return a * interval_detail::widened(1 / b.hi, 1 / b.lo);
}
inline Interval abs(const Interval& a) {
  if (a.lo >= 0) return a;
  return a.hi <= 0 ? -a : Interval(0, std::max(-a.lo, a.hi));
}
inline Interval square(const Interval& a) {
  const Interval b = abs(a);
  return interval_detail::widened(b.lo * b.lo, b.hi * b.hi);
}
inline Interval sqrt(const Interval& a) {
  if (!(a.hi >= 0)) return Interval::everything();
  return interval_detail::widened(a.lo > 0 ? std::sqrt(a.lo) : 0, std::sqrt(a.hi));
}
inline Interval exp(const Interval& a) { return interval_detail::rising(a, std::exp); }
inline Interval log(const Interval& a) {
  if (!(a.lo > 0)) return Interval::everything();
  return interval_detail::rising(a, std::log);
}
/// Extremes at k + phase turns (1) and half a turn later (-1).
inline Interval wave(const Interval& a, double phase, double at_lo, double at_hi) {
  if (!(a.hi - a.lo < kTwoPi) || !(std::max(std::abs(a.lo), std::abs(a.hi)) < 1e9)) return {-1, 1};
  const auto has = [&](double turns) {
    const double first = std::ceil(a.lo / kTwoPi - turns - 1e-6);
    return (first + turns) * kTwoPi <= a.hi + 1e-6;
  };
  const Interval r = interval_detail::widened(std::min(at_lo, at_hi), std::max(at_lo, at_hi));
  return {has(phase + 0.5) ? -1 : r.lo, has(phase) ? 1 : r.hi};
}
inline Interval sin(const Interval& a) { return wave(a, 0.25, std::sin(a.lo), std::sin(a.hi)); }
inline Interval cos(const Interval& a) { return wave(a, 0, std::cos(a.lo), std::cos(a.hi)); }
inline Interval tan(const Interval& a) { return sin(a) / cos(a); }
inline Interval sinh(const Interval& a) { return interval_detail::rising(a, std::sinh); }
inline Interval tanh(const Interval& a) { return interval_detail::rising(a, std::tanh); }
inline Interval cosh(const Interval& a) { return interval_detail::rising(abs(a), std::cosh); }
inline Interval atan(const Interval& a) { return interval_detail::rising(a, std::atan); }
inline Interval asin(const Interval& a) {
  if (a.hi < -1 || a.lo > 1) return Interval::everything();
  return interval_detail::rising({std::max(a.lo, -1.0), std::min(a.hi, 1.0)}, std::asin);
}
inline Interval acos(const Interval& a) { return Interval(kPi / 2) - asin(a); }
inline Interval atan2(const Interval& y, const Interval& x) {
  if (x.lo <= 0 && y.holds(0)) return {-3.2, 3.2};  // the origin, or the cut
  const double p[4] = {std::atan2(y.lo, x.lo), std::atan2(y.lo, x.hi), std::atan2(y.hi, x.lo), std::atan2(y.hi, x.hi)};
  return interval_detail::widened(*std::min_element(p, p + 4), *std::max_element(p, p + 4));
}
inline Interval power_of(const Interval& a, double p) {
  if (p == std::round(p) && std::abs(p) < 1e6 && !(a.lo > 0)) {
    const Interval even = std::fmod(p, 2) == 0 ? abs(a) : a;
    if (p < 0) return even.holds(0) ? Interval::everything() : Interval(1) / power_of(a, -p);
    return interval_detail::widened(std::pow(even.lo, p), std::pow(even.hi, p));
  }
  if (!(a.lo >= 0) || (a.lo == 0 && p < 0)) return Interval::everything();
  const double u = std::pow(a.lo, p), v = std::pow(a.hi, p);
  return interval_detail::widened(std::min(u, v), std::max(u, v));
}

/// Of a table nothing is known between its arguments.
inline Interval of_table(const MotionLaw&, const Interval&) { return Interval::everything(); }

}  // namespace lockstep::expression
