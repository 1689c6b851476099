// SPDX-License-Identifier: BSD-3-Clause
// Piece: a number over one step, as a polynomial through its values at five instants.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>

namespace lockstep::channels {

/// v(t) over a step, of degree four through its values at five evenly spaced instants; without states inside the step a
/// straight line.
struct Piece {
  static constexpr int kNodes = 5;
  double t0 = 0, t1 = 0;
  std::array<double, kNodes> v{};

  double t(int k) const { return t0 + (t1 - t0) * k / (kNodes - 1); }
  /// By Newton's forward differences.
  double at(double time) const {
    const double u = t1 > t0 ? (time - t0) / (t1 - t0) * (kNodes - 1) : 0;
    std::array<double, kNodes> d = v;
    double sum = v[0], term = 1;
    for (int k = 1; k < kNodes; ++k) {
      for (int i = 0; i + k < kNodes; ++i) d[i] = d[i + 1] - d[i];
      term *= (u - k + 1) / k;
      sum += term * d[0];
    }
    return sum;
  }
  /// The integral of f(v) from a to b, by Gauss and Legendre with five nodes: exact for v^2.
  template <class F>
  double integral(double a, double b, const F& f) const {
    return boost::math::quadrature::gauss<double, 5>::integrate([&](double time) { return f(at(time)); }, a, b);
  }
  /// Its largest value from a to b; with sign -1 the least.
  double most(double a, double b, double sign) const {
    double best = sign * std::max(sign * at(a), sign * at(b));
    constexpr int kParts = 8;
    const double h = (b - a) / kParts;
    for (int k = 1; k < kParts; ++k) {
      const double left = at(a + (k - 1) * h), here = at(a + k * h), right = at(a + (k + 1) * h);
      double top = here;
      if (sign * here >= sign * left && sign * here >= sign * right && left + right != 2 * here) {
        const double x = 0.5 * (left - right) / (left - 2 * here + right);  // the vertex, in parts
        top = at(a + (k + x) * h);
      }
      best = sign * std::max({sign * best, sign * here, sign * top});
    }
    return best;
  }
};

}  // namespace lockstep::channels
