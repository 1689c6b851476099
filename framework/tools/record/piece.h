// SPDX-License-Identifier: BSD-3-Clause
// Piece: a number over a part of a step, as a polynomial through its values at five instants.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "framework/foundation/math/limits.h"

namespace lockstep::channels {

using Row = std::vector<double>;            ///< an instant, values at it
using Samples = std::array<const Row*, 7>;  ///< of a part of a step: at five nodes, and at two irregular instants
inline constexpr std::array kSampled{0.0, 0.25, 0.382, 0.5, 0.75, 0.854, 1.0};  ///< these, of the part

/// v(t) over a smooth part of a step, of degree four through its values at five evenly spaced instants.
struct Piece {
  static constexpr int kNodes = 5;
  double t0 = 0, t1 = 0;
  std::array<double, kNodes> v{};

  /// Of the number at this place of rows.
  static Piece of(const Samples& s, std::size_t k) {
    return {(*s[0])[0], (*s[6])[0], {(*s[0])[k], (*s[1])[k], (*s[3])[k], (*s[4])[k], (*s[6])[k]}};
  }
  /// By how much the two samples that it does not use, and others, are beside it; 0 if there are no numbers.
  static double misfit(const Samples& s, std::size_t k, std::span<const Row* const> others = {}) {
    if (std::ranges::all_of(s, [k](const Row* row) { return std::isnan((*row)[k]); })) return 0;
    const Piece p = of(s, k);
    double sum = 0;
    const auto add = [&](const Row* row) { sum += row != nullptr ? std::abs(p.at((*row)[0]) - (*row)[k]) : NAN; };
    add(s[2]), add(s[5]);
    std::ranges::for_each(others, add);
    return sum;
  }
  static Piece line(double t0, double t1, double v0, double v1) {
    Piece p{t0, t1};
    for (int k = 0; k < kNodes; ++k) p.v[k] = std::lerp(v0, v1, k / (kNodes - 1.0));
    return p;
  }
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
