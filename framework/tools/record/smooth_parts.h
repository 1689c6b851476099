// SPDX-License-Identifier: BSD-3-Clause
// The smooth parts of a step: it is cut where a number changes its sign, and halved until polynomials agree with values
// that they do not use.
#pragma once

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "framework/foundation/math/limits.h"
#include "framework/tools/record/piece.h"

namespace lockstep::channels {

inline constexpr double kPart = 1e-5;  ///< of the range of a number: the error of its extremes
inline constexpr int kAlongLaws = 4;   ///< parts of a step if laws alone move the mechanism: 23 instants

/// Looks at a step. A row: an instant, values, then from place `edges` on numbers; if one changes its sign, a value may have
/// a kink, a jump or a pole there. `look`: the row at an instant, or null. `fits`: whether the samples of a part resolve it.
/// `take`: takes the samples of a part, and whether they do.
template <class Look, class Fits, class Take>
class SmoothParts {
 public:
  SmoothParts(std::size_t edges, const Look& look, const Fits& fits, const Take& take)
      : edges_(edges), look_(look), fits_(fits), take_(take) {}

  /// The step from a to b, in n parts at least, whose ends are at irregular instants, so that no period hides.
  void of_step(const Row& a, const Row& b, int n) const {
    const Row* from = &a;
    for (int i = 1; i <= n; ++i) {
      const double turn = i * std::numbers::phi, end = (i + 0.5 * (turn - std::floor(turn) - 0.5)) / n;
      const Row* const to = i == n ? &b : look_(std::lerp(a[0], b[0], end));
      if (to != nullptr) part(*from, *to, kDeepest), from = to;
    }
  }

 private:
  static constexpr int kDeepest = 8;  // a part is cut or halved so often at most

  void part(const Row& a, const Row& b, int left) const {
    if (!(a[0] < b[0])) return;
    Samples rows{&a};
    rows.back() = &b;
    for (std::size_t i = 1; i + 1 < rows.size(); ++i)
      if (rows[i] = look_(std::lerp(a[0], b[0], kSampled[i])); rows[i] == nullptr) return;
    for (const std::size_t i : std::array<std::size_t, 6>{3, 4, 2, 5, 1, 6})  // from the middle: few cuts reach many
      if (const std::size_t place = left > 0 ? edge_between(*rows[i - 1], *rows[i]) : 0; place != 0)
        return cut(rows, i, place, left - 1);
    const bool fits = fits_(rows);
    if (fits || left == 0) return take_(rows, fits);
    part(a, *rows[3], left - 1), part(*rows[3], b, left - 1);
  }

  static int side(double x) { return int(x > 0) - int(x < 0); }
  // The place of the first number that changes its sign between two rows, or is zero at one only; 0: none does.
  std::size_t edge_between(const Row& a, const Row& b) const {
    for (std::size_t i = edges_; i < std::min(a.size(), b.size()); ++i)
      if (side(a[i]) != side(b[i])) return i;
    return 0;
  }

  // Just before and just after this number changes its sign, before sample i.
  void cut(const Samples& rows, std::size_t i, std::size_t place, int left) const {
    const Row &a = *rows[i - 1], &b = *rows[i];
    const auto number = [&](double t) {
      const Row* const row = look_(t);
      return row == nullptr || place >= row->size() || std::isnan((*row)[place]) ? 0 : (*row)[place];
    };
    const double beside = kRoundOff * std::max(std::abs(a[0]), std::abs(b[0]));
    std::uintmax_t most = 100;  // looks; halving alone needs fewer
    const auto [from, to] = boost::math::tools::toms748_solve(
        number, a[0], b[0], a[place], b[place], [&](double l, double r) { return r - l <= beside; }, most);
    const double t = 0.5 * (from + to);
    const Row* const before = t - beside > a[0] ? look_(t - beside) : &a;
    const Row* const after = t + beside < b[0] ? look_(t + beside) : &b;
    if (before != nullptr) part(*rows.front(), *before, left);
    if (after != nullptr) part(*after, *rows.back(), left);
  }

  std::size_t edges_;
  const Look& look_;
  const Fits& fits_;
  const Take& take_;
};

}  // namespace lockstep::channels
