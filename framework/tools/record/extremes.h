// SPDX-License-Identifier: BSD-3-Clause
// Extremes: the extremes of columns over a motion, not only over its rows.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include <lockstep/recorder.h>
#include "framework/tools/record/smooth_parts.h"

namespace lockstep {

/// The extremes of columns over a motion that is seen at the ends of its steps, and inside the steps that may contain one.
/// The parabola through three instants about an extreme gives the next instant, until it predicts the value found there.
/// Without states inside steps, the vertex of the parabola through three ends of steps is the extreme.
class LOCKSTEP_API Extremes {
 public:
  using Numbers = std::span<const std::size_t>;  ///< of columns, after the time
  /// Values of these columns at an instant inside a step, and behind all values edges if cuts(); false if they
  /// cannot be computed.
  using Look = std::function<bool(double t, Numbers columns, std::vector<double>& values)>;

  /// Begins a motion of these columns, the first of which is the time. `edged`: those that have edges.
  void begin(const std::vector<Column>& columns, std::vector<std::size_t> edged = {});
  Numbers edged() const { return edged_; }
  bool cuts() const { return cuts_; }  ///< whether edges are asked for now
  /// Begins a part of it that is continuous: at its start, and after a jump.
  void begin_part(double t, std::span<const double> values);
  /// Adds a row of the table, the time first.
  void take_row(std::span<const double> row);
  /// Adds the step that ends at t. `n`: parts into which it is divided in any case. `look` may be empty.
  void add_step(double t, std::span<const double> values, int n, const Look& look);
  /// Of a column that reports it itself.
  void set_resolved(std::size_t column, bool resolved) { ranges_[column].resolved = resolved; }

  std::span<const ColumnRange> ranges() const { return ranges_; }  ///< of the columns after the time
  void save(Snapshot&) const;
  void load(SnapshotReader&);

 private:
  using Row = channels::Row;  // as of a table, and edges behind it
  void widen(double t, std::span<const double> values, Numbers columns);
  const Row& add_row(double t, std::span<const double> values, Numbers columns);
  const Row* look_at(double t, Numbers columns, const Look&);
  double slack(std::size_t k) const;
  bool is_seen(std::size_t k) const;
  struct Reach {
    double least, most, slope, bend;
  };
  Reach reach(std::size_t k, const Row& end) const;
  bool may_turn(std::size_t k, const Row& end) const;
  bool may_cross(const Row& end) const;
  void look_along(const Row& end, int n, const Look&);
  void divide(const Row* beside, const Row& a, const Row& b, int depth, const Look&);
  void refine(std::size_t k, const Row& a, const Row& m, const Row& b, const Look&);
  void join_ends(const Row& end);

  std::size_t width_ = 0;          // of a row
  std::vector<std::size_t> unit_,  // of each column, a number
      all_, edged_,                // columns
      turning_;                    // those that may have an extreme inside the step
  std::vector<double> largest_;    // of each unit, at both ends of a step
  std::vector<ColumnRange> ranges_;
  std::vector<long> unresolved_;  // in so many steps, by column
  std::vector<double> off_;       // by how much each may be off, as a range of which that is resolved
  Row before_, last_, values_;    // the ends of the two last steps; before_: empty after a jump or an edge
  std::deque<Row> rows_;          // of the present step
  std::size_t n_rows_ = 0;
  bool cuts_ = false;
};

}  // namespace lockstep
