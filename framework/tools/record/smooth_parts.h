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
#include <span>

#include "framework/foundation/math/limits.h"
#include "framework/tools/record/piece.h"

namespace lockstep::channels {

inline constexpr double kPart = 1e-5;  ///< of the range of a number: the error of its extremes
inline constexpr int kAlongLaws = 4;   ///< parts of a step if laws alone move the mechanism: 23 instants

/// The place, from one on, of the first number that changes its sign between two rows, or is zero at one only; 0: none.
inline std::size_t edge_between(const Row& a, const Row& b, std::size_t from) {
  const auto side = [](double x) { return int(x > 0) - int(x < 0); };
  for (std::size_t i = from; i < std::min(a.size(), b.size()); ++i)
    if (side(a[i]) != side(b[i]) && std::isfinite(a[i]) && std::isfinite(b[i])) return i;
  return 0;
}

/// Looks at a step. A row: an instant, values, then from place `edges` on numbers; if one changes its sign, a value may have
/// a kink, a jump or a pole there. `look`: the row at an instant, or null. `fits`: whether the samples of a part resolve it,
/// and the rows just before and after an edge among them. `take`: takes the samples of a part, and whether they do.
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
    std::size_t i = 0, edge = 0;
    for (const std::size_t k : std::array<std::size_t, 6>{3, 4, 2, 5, 1, 6})  // from the middle: few cuts reach many
      if (edge == 0) i = k, edge = edge_between(*rows[k - 1], *rows[k], edges_);
    const Beside beside = edge == 0 ? Beside{} : beside_edge(*rows[i - 1], *rows[i], edge);
    const bool fits = fits_(rows, std::span(beside).first(edge == 0 ? 0 : 2));
    if (fits || left == 0) return take_(rows, fits);
    const auto [before, after] = edge == 0 ? Beside{rows[3], rows[3]} : beside;
    if (before != nullptr) part(a, *before, left - 1);
    if (after != nullptr) part(*after, b, left - 1);
  }

  using Beside = std::array<const Row*, 2>;
  // Just before and just after the number at this place changes its sign between two rows.
  Beside beside_edge(const Row& a, const Row& b, std::size_t place) const {
    const auto number = [&](double t) {
      const Row* const row = look_(t);
      return row == nullptr || place >= row->size() || !std::isfinite((*row)[place]) ? 0 : (*row)[place];
    };
    const double beside = kRoundOff * std::max(std::abs(a[0]), std::abs(b[0]));
    std::uintmax_t most = 100;  // looks; halving alone needs fewer
    const auto [from, to] = boost::math::tools::toms748_solve(
        number, a[0], b[0], a[place], b[place], [&](double l, double r) { return r - l <= beside; }, most);
    const double t = 0.5 * (from + to);
    return {t - beside > a[0] ? look_(t - beside) : &a, t + beside < b[0] ? look_(t + beside) : &b};
  }

  std::size_t edges_;
  const Look& look_;
  const Fits& fits_;
  const Take& take_;
};

}  // namespace lockstep::channels
