// SPDX-License-Identifier: BSD-3-Clause
// RowEnvelope: the rows of a long run in memory: all of them, or enough of them for a picture.
#pragma once

#include <cstddef>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// The rows of a table while they are few. Beyond kMost, each column's least and largest value over equal numbers of
/// rows, in the order in which they came: a curve over time through them covers what a curve through all rows would.
/// For curves of one column against another, whole rows: one in 2, 4, 8, ... Memory does not grow with the run.
class LOCKSTEP_API RowEnvelope {
 public:
  static constexpr std::size_t kMost = 1 << 14;  ///< rows that are kept at most

  /// `columns`: a table with the same columns; `most`: a multiple of 4.
  explicit RowEnvelope(const Table& columns, std::size_t most = kMost);
  void clear();
  /// Adds row i of a table.
  void add(const Table&, std::size_t i);

  long n_rows() const { return n_rows_; }  ///< that were added
  /// The rows that are kept, for curves over time: a row of it may hold numbers of different times.
  Table table() const;
  /// Whole rows, for curves of one column against another: one in path_every(), and the last.
  Table path_table() const;
  long path_every() const { return path_every_; }   ///< 1: all rows
  std::size_t n_columns() const { return width_; }  ///< with the time

  void save(Snapshot&) const;
  void load(SnapshotReader&);

 private:
  void thin();
  void thin_path();
  void take_extremes(const double* rows, std::size_t n, double* pair) const;
  std::size_t n_kept() const { return kept_.size() / width_; }

  Table columns_;
  std::size_t width_, most_;
  std::vector<double> kept_;  // row by row; in pairs once rows are grouped
  std::vector<double> path_;  // whole rows, one in path_every_; empty while kept_ has all
  long per_pair_ = 1, path_every_ = 1, n_rows_ = 0;
  long n_open_ = 0;           // rows of the group that is not full yet,
  std::vector<double> open_,  // the pair of their extremes, and room for the next row
      last_;
};

}  // namespace lockstep
