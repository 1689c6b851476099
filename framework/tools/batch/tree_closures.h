// SPDX-License-Identifier: BSD-3-Clause
// TreeClosures: the rows that close the loops of a batch in joint coordinates: their arrays, and the rule by which each
// lane is corrected. Private to the room.
#pragma once

#include <array>

#include <lockstep/author/memory.h>
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/tools/batch/lane_passes.h"
#include "framework/tools/batch/packs.h"

namespace lockstep::lanes {

class TreeClosures {
 public:
  using Systems = std::array<System*, kLanes>;
  using Layouts = std::array<const TreeLayout*, kLanes>;
  /// Of systems whose layouts are alike, whose tree is in the data; nothing where these have no rows. The data and passes
  /// outlive this.
  TreeClosures(const Systems&, const Layouts&, LaneData&, const Passes&);

  bool empty() const { return data_.loops.empty(); }
  bool has_laws() const { return has_laws_; }
  /// Whether links write rows of their own, which needs the motions of the copies.
  bool has_own_rows() const { return !data_.loops.own.empty(); }
  /// Sets the laws of the links of one copy, and the rows that they write. Throws what they throw.
  void fill(const System&, int lane, const Inputs&);

  /// Accelerations at the motions that the tree has; true in the lanes whose rows are not met. The first n are looked at.
  Flags8 accelerate(int n, double* rate);
  /// Of the last of them: how many pivots are small, and the smallest of the others, relative to its diagonal.
  void see_pivots();
  double n_small(int lane) const { return pivots_[lane]; }
  double smallest_pivot(int lane) const { return pivots_[kLanes + lane]; }

  /// C and Cd = J v + Ct at the motions that the tree has; the second alone after new velocities.
  void gather() { pass_.closure_errors(data_); }
  void gather_rates() { pass_.closure_rates(data_); }
  /// Their largest numbers, as Evaluation::norm measures them.
  Numbers8 norm_C() { return norm(data_.c.rows.C); }
  Numbers8 norm_Cd() { return norm(data_.c.Cd); }
  /// The elimination of the rows as gathered last.
  void factor() { pass_.factor_closures(data_); }
  /// The change of the velocities of least kinetic energy by which C or Cd vanish in the wanted lanes; none in others.
  const double* correct_C(const Flags8& wanted) { return correct(data_.c.rows.C, wanted); }
  const double* correct_Cd(const Flags8& wanted) { return correct(data_.c.Cd, wanted); }

 private:
  void measure_floors();
  // Residuals of rows, relative to their scales: the largest, and that of rows that are not redundant.
  struct Residuals {
    Numbers8 all, regular;
    bool met(int lane) const { return all[lane] <= kRowTolerance; }
  };
  Residuals residuals();
  Numbers8 norm(std::span<const double>);
  const double* correct(std::span<const double> r, const Flags8& wanted);

  LaneData& data_;
  const Passes& pass_;
  RowTable scratch_;  // of one link
  bool has_laws_ = false, floors_known_ = false;
  Arrays arrays_;  // of data_.c
  Aligned<double> masked_, dv_, length_;
  alignas(64) std::array<double, 2 * kLanes> pivots_{};        // n_small, smallest_pivot
  alignas(64) std::array<double, 3 * kLanes> pivot_floors_{};  // one pack per RowKind
};

}  // namespace lockstep::lanes
