// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/record/extremes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "framework/foundation/math/limits.h"

namespace lockstep {

namespace {

constexpr double kMisfit = 0.1;   // of the range of a column: by how much a value may differ from a curve by others
constexpr int kDeepest = 3;       // a step is halved so often at most
constexpr long kMostNoisy = 8;    // unresolved steps; of a column with more, only the ends of steps count
constexpr int kMostVertices = 8;  // looks at one extreme

struct Point {
  double t, v;
};
Point point(const std::vector<double>& row, std::size_t k) { return {row[0], row[k + 1]}; }

/// a.v + d (t - a.t) + c (t - a.t) (t - m.t), through three points.
struct Parabola {
  Point a, m;
  double d, c;
  Parabola(const Point& first, const Point& middle, const Point& last)
      : a(first), m(middle), d((m.v - a.v) / (m.t - a.t)), c(((last.v - m.v) / (last.t - m.t) - d) / (last.t - a.t)) {}
  double at(double t) const { return a.v + (d + c * (t - m.t)) * (t - a.t); }
  double vertex() const { return 0.5 * (a.t + m.t - d / c); }
};

// How far v is outside of a range.
double beyond(const ColumnRange& range, double v) { return std::max(v - range.most, range.least - v); }

}  // namespace

void Extremes::begin(const std::vector<Column>& columns, std::vector<std::size_t> edged) {
  width_ = columns.size(), edged_ = std::move(edged);
  std::vector<std::string> units;
  unit_.clear();
  for (std::size_t k = 1; k < width_; ++k) {
    unit_.push_back(static_cast<std::size_t>(std::ranges::find(units, columns[k].unit) - units.begin()));
    if (unit_.back() == units.size()) units.push_back(columns[k].unit);
  }
  largest_.assign(units.size(), 0), unresolved_.assign(width_ - 1, 0), off_.assign(width_ - 1, 0), values_.resize(width_ - 1);
  ranges_.clear(), before_.clear(), last_.clear(), all_.resize(width_ - 1);
  std::iota(all_.begin(), all_.end(), 0);
}

void Extremes::widen(double t, std::span<const double> values, Numbers columns) {
  if (ranges_.empty())
    for (const double x : values.first(width_ - 1)) ranges_.push_back({x, x, x, t, t});
  for (const std::size_t k : columns) {
    ColumnRange& range = ranges_[k];
    const double x = values[k];
    if (!(range.least <= x) && !std::isnan(range.least)) range.least = x, range.t_least = t;  // a NaN stays
    if (!(range.most >= x) && !std::isnan(range.most)) range.most = x, range.t_most = t;
  }
}

void Extremes::take_row(std::span<const double> row) {
  widen(row[0], row.subspan(1), all_);
  for (std::size_t k = 0; k + 1 < width_; ++k) ranges_[k].last = row[k + 1];
}

const Extremes::Row& Extremes::add_row(double t, std::span<const double> values, Numbers columns) {
  widen(t, values, columns);
  if (n_rows_ == rows_.size()) rows_.emplace_back();
  Row& row = rows_[n_rows_++];
  row.assign(1, t);
  row.insert(row.end(), values.begin(), values.end());
  return row;
}

const Extremes::Row* Extremes::look_at(double t, Numbers columns, const Look& look) {
  values_.resize(width_ - 1);
  return look(t, columns, values_) ? &add_row(t, values_, columns) : nullptr;
}

void Extremes::begin_part(double t, std::span<const double> values) {
  n_rows_ = 0;
  last_ = add_row(t, values, all_), before_.clear();
}

void Extremes::add_step(double t, std::span<const double> values, int n, const Look& look) {
  n_rows_ = 0;
  const Row& end = add_row(t, values, all_);
  for (std::size_t k = 0; k + 1 < width_; ++k) {
    double& largest = largest_[unit_[k]];  // what is as large at one instant only does not count
    const double size = std::min(std::abs(last_[k + 1]), std::abs(end[k + 1]));
    if (size < HUGE_VAL) largest = std::max(largest, size);
  }
  if (!look) {
    join_ends(end);
  } else {
    turning_.clear();
    const bool along = n > 1 || may_cross(end);
    for (const std::size_t k : all_)
      if (n == 1 && is_seen(k) && may_turn(k, end) && !(along && std::ranges::binary_search(edged_, k)))
        turning_.push_back(k);
    if (!turning_.empty()) divide(before_.empty() ? nullptr : &before_, last_, end, 0, look);
    cuts_ = along, turning_ = n > 1 ? all_ : edged_;
    if (along) look_along(end, n, look);
    cuts_ = false;
  }
  std::swap(before_, last_);
  last_ = end;
  if (channels::edge_between(before_, last_, width_) != 0) before_.clear();  // no parabola goes across an edge
  for (std::size_t k = 0; k + 1 < width_; ++k) {
    const double range = ranges_[k].most - ranges_[k].least;
    ranges_[k].resolved = off_[k] <= range && range < HUGE_VAL;
  }
}

// Columns with edges, or all along laws.
void Extremes::look_along(const Row& end, int n, const Look& look) {
  const auto at = [&](double t) { return look_at(t, turning_, look); };
  const auto limit = [&](std::size_t k) { return kMisfit * (ranges_[k].most - ranges_[k].least) + slack(k); };
  const auto fits = [&](const channels::Samples& rows, std::span<const Row* const> edge) {
    return std::ranges::all_of(turning_, [&](std::size_t k) {
      return !is_seen(k) || channels::Piece::misfit(rows, k + 1, edge) <= (edge.empty() ? limit(k) : slack(k));
    });
  };
  const auto take = [&](const channels::Samples& rows, bool) {
    for (const std::size_t k : turning_) {
      if (const double off = channels::Piece::misfit(rows, k + 1); !(off <= limit(k)))
        ++unresolved_[k], off_[k] = std::max(off_[k], off / kMisfit);
      double inner = 0;
      for (std::size_t i = 1; i < 6; ++i) inner = std::max(inner, std::abs((*rows[i])[k + 1]));
      const double outer = std::max(std::abs((*rows[0])[k + 1]), std::abs((*rows[6])[k + 1]));
      if (channels::kPart * outer > inner && outer > slack(k)) off_[k] = HUGE_VAL;  // a pole
      for (std::size_t i = 2; i < rows.size(); ++i) refine(k, *rows[i - 2], *rows[i - 1], *rows[i], look);
    }
  };
  channels::SmoothParts(width_, at, fits, take).of_step(last_, end, n);
}

double Extremes::slack(std::size_t k) const {
  return std::max(channels::kPart * (ranges_[k].most - ranges_[k].least), kNegligible * largest_[unit_[k]]);
}
bool Extremes::is_seen(std::size_t k) const { return unresolved_[k] <= kMostNoisy; }

// Bounds of a number inside the last step: those of the parabola through three ends of steps, with four times its height
// over the chord.
Extremes::Reach Extremes::reach(std::size_t k, const Row& end) const {
  const Point a = point(last_, k), b = point(end, k);
  const double h = b.t - a.t, bend = std::abs(Parabola(point(before_, k), a, b).c) * h;
  return {std::min(a.v, b.v) - bend * h, std::max(a.v, b.v) + bend * h, std::abs(b.v - a.v) / h, bend};
}

// Whether the last step may contain an extreme beyond those known: its slope may change by twice that of the parabola.
bool Extremes::may_turn(std::size_t k, const Row& end) const {
  const ColumnRange& range = ranges_[k];
  if (before_.empty()) return range.most - range.least > slack(k);
  const auto [least, most, slope, bend] = reach(k, end);
  return std::max(beyond(range, most), beyond(range, least)) > slack(k) && 2 * bend > slope;
}

// Whether a number behind the values may change its sign inside the last step.
bool Extremes::may_cross(const Row& end) const {
  if (edged_.empty()) return false;
  if (before_.size() != end.size() || last_.size() != end.size()) return true;
  for (std::size_t k = width_ - 1; k + 1 < end.size(); ++k) {
    const Reach r = reach(k, end);
    if (!(r.least > 0 || r.most < 0 || (r.least == 0 && r.most == 0))) return true;
  }
  return false;
}

// Halves a step, and again if a value is not where the parabola through others is.
void Extremes::divide(const Row* beside, const Row& a, const Row& b, int depth, const Look& look) {
  const Row* const m = look_at(0.5 * (a[0] + b[0]), turning_, look);
  if (m == nullptr) return;
  bool misfits = beside == nullptr;
  for (const std::size_t k : turning_) {
    const Point p = point(a, k), q = point(*m, k), r = point(b, k);
    const double off = beside == nullptr ? 0 : std::abs(Parabola(point(*beside, k), p, r).at(q.t) - q.v);
    if (off > kMisfit * (ranges_[k].most - ranges_[k].least) + slack(k)) {
      misfits = true;
      if (depth == kDeepest) ++unresolved_[k], off_[k] = std::max(off_[k], off / kMisfit);
    }
    refine(k, a, *m, b, look);
  }
  if (misfits && depth < kDeepest) divide(&b, a, *m, depth + 1, look), divide(&a, *m, b, depth + 1, look);
}

void Extremes::refine(std::size_t k, const Row& first, const Row& middle, const Row& last, const Look& look) {
  Point a = point(first, k), m = point(middle, k), b = point(last, k);
  for (int n = 0; n < kMostVertices; ++n) {
    const Parabola p(a, m, b);
    const double t = p.vertex(), v = p.at(t);
    if (!(a.t < t && t < b.t && beyond(ranges_[k], v) > slack(k))) return;
    const Row* const found = t == m.t ? nullptr : look_at(t, Numbers(&k, 1), look);
    if (found == nullptr) return;
    const Point at = point(*found, k);
    if (std::abs(at.v - v) <= slack(k)) return;
    const Point &left = t < m.t ? at : m, &right = t < m.t ? m : at;
    const bool first_is_better = p.c < 0 ? left.v >= right.v : left.v <= right.v;
    if (first_is_better)
      b = right, m = left;
    else
      a = left, m = right;
  }
  off_[k] = std::max(off_[k], std::abs(m.v - a.v) / kMisfit);
}

void Extremes::join_ends(const Row& end) {
  constexpr double kCoarse = 1e-2;  // of the range: a parabola this high over the ends of steps is inaccurate
  for (std::size_t k = 0; !before_.empty() && k + 1 < width_; ++k) {
    const Point a = point(before_, k), m = point(last_, k), b = point(end, k);
    if ((m.v - a.v) * (b.v - m.v) > 0) continue;
    const Parabola p(a, m, b);
    const double t = p.vertex(), v = p.at(t);
    ColumnRange& range = ranges_[k];
    if (!(beyond(range, v) > slack(k))) continue;
    off_[k] = std::max(off_[k], beyond(range, v) / kCoarse);
    if (v > range.most)
      range.most = v, range.t_most = t;
    else
      range.least = v, range.t_least = t;
  }
}

void Extremes::save(Snapshot& out) const {
  out.put(static_cast<double>(ranges_.size()));
  for (const ColumnRange& r : ranges_)
    for (const double x : {r.last, r.least, r.most, r.t_least, r.t_most, r.resolved ? 1.0 : 0.0}) out.put(x);
  for (const Row* row : {&before_, &last_, &largest_, &off_}) out.put_all(*row);
  out.put_all(unresolved_);
}

void Extremes::load(SnapshotReader& in) {
  ranges_.resize(static_cast<std::size_t>(in.get_count()));
  for (ColumnRange& r : ranges_) {
    for (double* x : {&r.last, &r.least, &r.most, &r.t_least, &r.t_most}) *x = in.get();
    r.resolved = in.get_flag();
  }
  for (Row* row : {&before_, &last_, &largest_, &off_}) in.get_all(*row);
  in.get_all(unresolved_);
}

}  // namespace lockstep
