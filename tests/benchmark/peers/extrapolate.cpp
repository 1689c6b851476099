// SPDX-License-Identifier: BSD-3-Clause
#include "tests/benchmark/peers/extrapolate.h"

#include <array>

namespace lockstep::peers {

namespace {

constexpr int kRows = 8;

// y(H) by `n` midpoint steps of h = H/n: y1 = y0 + h f0; y(k+1) = y(k-1) + 2 h f(k); then (y(n-1) + y(n) + h f(n))/2.
RealVector midpoint(const RateOf& rate, const RealVector& y0, const RealVector& f0, Real H, int n) {
  const Real h = H / n;
  RealVector before = y0, now = y0, f = f0;
  for (std::size_t i = 0; i < y0.size(); ++i) now[i] += h * f0[i];
  for (int k = 1; k < n; ++k) {
    rate(now, f);
    for (std::size_t i = 0; i < y0.size(); ++i) before[i] += 2 * h * f[i];
    std::swap(before, now);
  }
  rate(now, f);
  for (std::size_t i = 0; i < y0.size(); ++i) now[i] = (before[i] + now[i] + h * f[i]) / 2;
  return now;
}

// Neville's scheme in h^2: T(j, k+1) = T(j, k) + (T(j, k) - T(j-1, k)) / ((n_j/n_(j-k-1))^2 - 1), n_j = 2 (j + 1).
void step(const RateOf& rate, RealVector& y, Real H) {
  RealVector f0 = y;
  rate(y, f0);
  std::array<RealVector, kRows> row;  // T(j-1, .), becomes T(j, .)
  for (int j = 0; j < kRows; ++j) {
    RealVector entry = midpoint(rate, y, f0, H, 2 * (j + 1));
    for (int k = 0; k < j; ++k) {
      const Real ratio = Real(j + 1) / Real(j - k), q = ratio * ratio - 1;
      RealVector& above = row[k];
      RealVector next = entry;
      for (std::size_t i = 0; i < y.size(); ++i) next[i] += (entry[i] - above[i]) / q;
      above = std::move(entry);
      entry = std::move(next);
    }
    row[j] = std::move(entry);
  }
  y = row[kRows - 1];
}

}  // namespace

void extrapolate(const RateOf& rate, RealVector& y, Real length, int steps) {
  for (int k = 0; k < steps; ++k) step(rate, y, length / steps);
}

}  // namespace lockstep::peers
