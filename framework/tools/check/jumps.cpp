#include "framework/tools/check/jumps.h"

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

constexpr int kHalvings = 34;
constexpr double kSmallest = 1e-6;  // jump, relative to the size of its component

using Function = std::function<void(double, VecX&)>;

struct Cell {
  double a, b;
  VecX fa, fm, fb;
  double bend(Eigen::Index c) const { return std::abs(fm[c] - 0.5 * (fa[c] + fb[c])); }
};

Cell cell(const Function& f, double a, double b) {
  Cell r{a, b, {}, {}, {}};
  f(a, r.fa), f(0.5 * (a + b), r.fm), f(b, r.fb);
  return r;
}

// The point where component c bends most, and its change there; a jump of J bends by J/2 in every cell around it.
Jump narrow(const Function& f, Cell w, Eigen::Index c, double size) {
  for (int k = 0; k < kHalvings && w.bend(c) > 0.1 * kSmallest * size; ++k) {
    const double m = 0.5 * (w.a + w.b);
    Cell left{w.a, m, w.fa, {}, w.fm}, right{m, w.b, w.fm, {}, w.fb};
    f(0.5 * (w.a + m), left.fm), f(0.5 * (m + w.b), right.fm);
    w = left.bend(c) >= right.bend(c) ? left : right;
  }
  const bool smooth = !(w.bend(c) > 0.1 * kSmallest * size);
  return {0.5 * (w.a + w.b), smooth ? 0.0 : w.fb[c] - w.fa[c]};
}

}  // namespace

std::map<int, std::vector<Jump>> find_jumps(const Function& f, double t0, double t1, std::vector<double> known,
                                            int cells) {
  const double clear = 1e-9 * (t1 - t0);  // kept from the known instants
  known.push_back(t0), known.push_back(t1);
  std::erase_if(known, [&](double t) { return t < t0 || t > t1; });
  std::vector<double> borders = known;
  for (int i = 0; i <= cells; ++i) borders.push_back(t0 + (t1 - t0) * i / cells);
  std::sort(borders.begin(), borders.end());
  const auto away_from_known = [&](double x, double direction) {
    for (const double t : known)
      if (std::abs(x - t) < clear) x = t + direction * clear;
    return x;
  };
  std::vector<Cell> all;
  VecX size;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    const double a = away_from_known(borders[i], 1), b = away_from_known(borders[i + 1], -1);
    if (!(b > a)) continue;
    all.push_back(cell(f, a, b));
    const VecX most = all.back().fa.cwiseAbs().cwiseMax(all.back().fb.cwiseAbs());
    size = size.size() == 0 ? most : VecX(size.cwiseMax(most));
  }
  if (size.size() > 0) size = size.cwiseMax(1e-10 * size.maxCoeff());  // less is rounding
  std::map<int, std::vector<Jump>> jumps;
  for (const Cell& w : all)
    for (int c = 0; c < size.size(); ++c)
      if (const Jump found = narrow(f, w, c, size[c]); std::abs(found.size) > kSmallest * size[c])
        jumps[c].push_back(found);
  return jumps;
}

}  // namespace lockstep
