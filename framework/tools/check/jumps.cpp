// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/compare.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <lockstep/text.h>

namespace lockstep {
namespace {

constexpr int kHalvings = 34;

// A component changes by `size` at time t, which is known to about 1e-9 of the interval.
struct Jump {
  double t, size;
};

struct Cell {
  double a, b;
  VecX fa, fm, fb;
  double bend(Eigen::Index c) const { return std::abs(fm[c] - 0.5 * (fa[c] + fb[c])); }
};

// The point where component c bends most, and its change there; a jump of J bends by J/2 in every cell around it.
Jump narrow(const Curve& f, Cell w, Eigen::Index c, double size) {
  for (int k = 0; k < kHalvings && w.bend(c) > 0.1 * kSlight * size; ++k) {
    const double m = 0.5 * (w.a + w.b);
    const Cell left{w.a, m, w.fa, f(0.5 * (w.a + m)), w.fm}, right{m, w.b, w.fm, f(0.5 * (m + w.b)), w.fb};
    w = left.bend(c) >= right.bend(c) ? left : right;
  }
  const bool smooth = !(w.bend(c) > 0.1 * kSlight * size);
  return {0.5 * (w.a + w.b), smooth ? 0.0 : w.fb[c] - w.fa[c]};
}

// Jumps of each component of f inside (t0, t1), in order of time, more than 1e-9 of the interval away from the
// instants `known`. Each of `cells` cells is bisected, always into the half in which f departs most from the mean of
// its ends: what does not vanish is a jump. Finds jumps of more than 1e-6 of the component's size (which counts as at
// least 1e-10 of the largest component's); of several in one cell, the largest.
std::map<int, std::vector<Jump>> find_jumps(const Curve& f, double t0, double t1, std::vector<double> known,
                                            int cells) {
  const double clear = kNegligible * (t1 - t0);  // kept from the known instants
  known.push_back(t0), known.push_back(t1);
  std::erase_if(known, [&](double t) { return t < t0 || t > t1; });
  std::sort(known.begin(), known.end());
  std::vector<Cell> all;
  VecX size;
  for (std::size_t i = 0; i + 1 < known.size(); ++i) {
    const double begin = known[i] + clear, length = known[i + 1] - clear - begin;
    const int n = length > 0 ? static_cast<int>(std::ceil(cells * length / (t1 - t0))) : 0;
    for (int k = 0; k < n; ++k) {
      const double a = begin + length * k / n, b = begin + length * (k + 1) / n;
      all.push_back({a, b, f(a), f(0.5 * (a + b)), f(b)});
      const VecX most = all.back().fa.cwiseAbs().cwiseMax(all.back().fb.cwiseAbs());
      size = size.size() == 0 ? most : VecX(size.cwiseMax(most));
    }
  }
  if (size.size() > 0) size = size.cwiseMax(kRounding * size.maxCoeff());  // less is rounding
  std::map<int, std::vector<Jump>> jumps;
  for (const Cell& w : all)
    for (int c = 0; c < size.size(); ++c)
      if (const Jump found = narrow(f, w, c, size[c]); std::abs(found.size) > kSlight * size[c])
        jumps[c].push_back(found);
  return jumps;
}

}  // namespace

std::vector<double> listed_breakpoints(const TimedNumbers& f, const CheckOptions& options, CheckReport& report) {
  const double before = options.from - 1;
  std::vector<double> told{before};
  f.breakpoints(options.from, options.to, told);
  if (told.empty() || told.front() != before)
    report.add("append", {"breakpoints() removes earlier entries of the list", "breakpoints(): it has to append"});
  std::erase(told, before);
  for (const double t : told)
    if (!(t > options.from && t < options.to))
      report.add("outside", {fmt::format("breakpoints({}, {}) reports {} s, which is not between them",
                                         text::number(options.from), text::number(options.to), text::number(t)),
                             "breakpoints(): it appends only times in (t0, t1)"});
  std::sort(told.begin(), told.end());
  return told;
}

void check_jumps(const TimedNumbers& f, const CheckOptions& options, CheckReport& report, int cells, int n_keys) {
  const std::vector<double> told = listed_breakpoints(f, options, report);
  for (const auto& [c, all] : find_jumps(f.at, options.from, options.to, told, cells)) {
    std::vector<std::string> instants;
    for (const Jump& j : all) instants.push_back(fmt::format("{:.9g}", j.t));
    const std::size_t n = instants.size();
    if (n > 3) instants.resize(3);
    report.add(fmt::format("jump {}", c % n_keys),
               {fmt::format("{} jumps by {:.3g} at t = {} s{}, which breakpoints() does not report", f.name(c),
                            all.front().size, text::join(instants, n > 3 ? ", " : " and "),
                            n > 3 ? fmt::format(" and {} more", n - 3) : ""),
                f.look});
  }
}

}  // namespace lockstep
