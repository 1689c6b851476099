// SPDX-License-Identifier: BSD-3-Clause
// ClosureRows: the rows of links that are not in the tree, without their use in the recursion.
#pragma once

#include <span>
#include <vector>

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/dynamics/tree/closure_fronts.h"

namespace lockstep {

inline constexpr double kStalledRows = 0.3;  ///< of a residual: a correction that leaves more is the last one

/// The residuals C and J v + Ct of rows gathered at these motions, one per row of the table.
void find_residuals(const RowTable&, std::span<const Motion> motions, VecX& C, VecX& Cd);

/// Right sides, scales, multipliers and residuals of the rows of closures.
class LOCKSTEP_API ClosureRows {
 public:
  bool empty() const { return fronts_.sources.empty(); }
  /// c <- c - x; after the rows were read.
  void subtract(const VecX& x);
  /// The largest number of c, one per row: as Evaluation::norm measures it.
  double norm(const VecX& c) const;
  double residual() const { return worst_; }  ///< the largest as found last, relative to its scale
  /// Whether the residual that a correction has changed from `before` is that of redundant rows off the constraints: it
  /// stays as it is, is below a contradiction, regular rows are met, and no more pivots are small than rows are redundant.
  bool is_left_by_redundant_rows(double before) const;
  /// Fills in residual, worst row, pivots and detector.
  void complete(SolveReport&);
  /// How many of the rows are redundant, as Kkt::redundant; unknown at first.
  int redundant() const { return redundant_; }
  void set_redundant(int n) { redundant_ = n; }

  const VecX& lambda() const { return lambda_; }  ///< one per row of the table

 protected:
  ClosureRows() = default;
  ~ClosureRows() = default;
  /// mass_ratio: of the heaviest slot to the lightest.
  void begin(ClosureFronts, double length, double mass_ratio);
  /// From diagonal_.
  void measure_scales(const RowTable&);
  /// From r_ and size_: whether the residuals are small enough. `corrected`: they are those of a correction.
  bool is_met(bool corrected);

  ClosureFronts fronts_;
  std::vector<double> Lambda_, V_, l_;                 // l by place
  VecX c_, diagonal_, scale_, d_, lambda_, r_, size_;  // by row; scale_: s_j
  VecX dlambda_, du_;                                  // of a correction: by row, by coordinate
  int n_small_ = 0;                                    // pivots of the last elimination that got a proximal term

 private:
  PivotWatch watch_;
  double length_ = 1, worst_ = 0;
  int worst_row_ = -1, redundant_ = Kkt::kUnknown;
  bool regular_met_ = false, differ_in_mass_ = false;
};

}  // namespace lockstep
