// SPDX-License-Identifier: BSD-3-Clause
// Piece: a number over one step, as a polynomial through its values at five instants.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>

#include "framework/foundation/math/limits.h"

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
  /// Its largest value from a to b; with sign -1 the least. A peak of a grid is refined on `v_at`, v at a time.
  template <class V>
  double most(double a, double b, double sign, const V& v_at) const {
    constexpr int kParts = 8, kDigits = std::numeric_limits<double>::digits / 2;
    const double h = (b - a) / kParts;
    const auto on_grid = [&](int k) { return sign * at(a + k * h); };
    double best = -HUGE_VAL;
    for (int k = 0; k <= kParts; ++k) {
      const double here = on_grid(k), left = here - on_grid(k - 1), right = here - on_grid(k + 1);
      best = std::max(best, here);
      if (left < 0 || right < 0 || left + right <= kRoundOff * std::abs(here) || here + left + right < best) continue;
      const double from = std::max(a, a + (k - 1) * h), to = std::min(b, a + (k + 1) * h);
      const auto below = [&](double part) { return -sign * v_at(std::lerp(from, to, part)); };
      best = std::max(best, -boost::math::tools::brent_find_minima(below, 0.0, 1.0, kDigits).second);
    }
    return sign * best;
  }
};

}  // namespace lockstep::channels
