#include "framework/tools/check/jumps.h"

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

constexpr int kHalvings = 34;
constexpr double kSmallest = 1e-6;  // jump, of the size of its component

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

// Where component c bends most, and by how much it changes there; a jump of J bends by J/2 in every cell around it.
Jump narrow(const Function& f, Cell w, Eigen::Index c, double size) {
  for (int k = 0; k < kHalvings && w.bend(c) > 0.1 * kSmallest * size; ++k) {
    const double m = 0.5 * (w.a + w.b);
    Cell left{w.a, m, w.fa, {}, w.fm}, right{m, w.b, w.fm, {}, w.fb};
    f(0.5 * (w.a + m), left.fm), f(0.5 * (m + w.b), right.fm);
    w = left.bend(c) >= right.bend(c) ? left : right;
  }
  const bool smooth = !(w.bend(c) > 0.1 * kSmallest * size);
  return {0.5 * (w.a + w.b), static_cast<int>(c), smooth ? 0.0 : w.fb[c] - w.fa[c]};
}

}  // namespace

std::vector<Jump> find_jumps(const Function& f, double t0, double t1, std::vector<double> known, int cells) {
  known.push_back(t0), known.push_back(t1);  // what happens there is outside
  struct Border {
    double t, clear;  // how far from it nothing is looked at
  };
  std::vector<Border> borders;
  for (int i = 0; i <= cells; ++i) borders.push_back({t0 + (t1 - t0) * i / cells, 0});
  for (const double t : known)
    if (t >= t0 && t <= t1) borders.push_back({t, 1e-9 * (t1 - t0)});
  std::sort(borders.begin(), borders.end(), [](const Border& a, const Border& b) { return a.t < b.t; });
  std::vector<Cell> all;
  VecX size;
  for (std::size_t i = 0; i + 1 < borders.size(); ++i) {
    double a = borders[i].t + borders[i].clear, b = borders[i + 1].t - borders[i + 1].clear;
    for (const double t : known) {  // a border of a cell may lie beside one that is known
      if (std::abs(a - t) < 1e-9 * (t1 - t0)) a = t + 1e-9 * (t1 - t0);
      if (std::abs(b - t) < 1e-9 * (t1 - t0)) b = t - 1e-9 * (t1 - t0);
    }
    if (!(b > a)) continue;
    all.push_back(cell(f, a, b));
    const VecX most = all.back().fa.cwiseAbs().cwiseMax(all.back().fb.cwiseAbs());
    size = size.size() == 0 ? most : VecX(size.cwiseMax(most));
  }
  if (size.size() > 0) size = size.cwiseMax(1e-10 * size.maxCoeff());  // less is rounding
  std::vector<Jump> jumps;
  for (const Cell& w : all)
    for (Eigen::Index c = 0; c < size.size(); ++c)
      if (const Jump found = narrow(f, w, c, size[c]); std::abs(found.size) > kSmallest * size[c])
        jumps.push_back(found);
  return jumps;
}

}  // namespace lockstep
