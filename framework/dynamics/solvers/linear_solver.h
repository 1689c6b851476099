// LinearSolver: solves the saddle-point system of one evaluation, whatever the topology and however redundant the rows.
#pragma once

#include <limits>
#include <string_view>

#include "framework/dynamics/solvers/kkt.h"

namespace lockstep {

struct SolveReport {
  double residual = 0;  ///< largest |J a - c| over the rows, each against its own scale
  int worst_row = -1;   ///< the row of that residual
  int corrections = 0;  ///< proximal corrections made
  int rank = -1;        ///< rank of J where the solver reveals it, else -1
  double smallest_pivot = std::numeric_limits<double>::infinity();  ///< relative; small: redundant or singular
  /// The smallest relative pivot beyond those of rows that are redundant everywhere: falls as the square of the
  /// distance to a singular position. Infinite where the solver does not tell.
  double detector = std::numeric_limits<double>::infinity();
  bool contradictory = false;  ///< the rows cannot all hold: the residual stays at the order of its scale
};

/// Siblings keep the order analyse, factor, solve. Nothing is allocated after analyse (Eigen's own sparse factorisation
/// may).
class LOCKSTEP_API LinearSolver {
 public:
  virtual ~LinearSolver();
  virtual std::string_view name() const = 0;
  /// When the set of active links changed: sizes, ordering, symbolic work.
  virtual void analyse(const KktPattern&) = 0;
  /// Numbers of the matrix.
  virtual void factor(const Kkt&) = 0;
  /// M a + J^T lambda = f, J a = c, by the last factor; of all lambda the smallest in the metric of E.
  virtual SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) = 0;
  /// Fills what a report costs time to know (residual, pivots, detector) where solve() left it out; only when somebody
  /// looks.
  virtual void complete(SolveReport&) const {}
  /// Whether it takes the rows from KktPattern::rows instead of M, J and E.
  virtual bool reads_rows() const { return false; }
};

}  // namespace lockstep
