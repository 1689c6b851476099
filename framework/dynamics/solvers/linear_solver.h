// LinearSolver and Factorization: solve the saddle-point system of one evaluation, whatever the topology and however
// redundant the rows.
#pragma once

#include <limits>
#include <memory>
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

/// The numbers of one factored matrix, and its solutions. Nothing is allocated after LinearSolver::analyse() (Eigen's own
/// sparse factorisation may). Earlier matrices of the same factorization tell redundant rows from a singular position.
class LOCKSTEP_API Factorization {
 public:
  virtual ~Factorization();
  /// Factors this matrix, whose shape is the analysed one. Throws SolveError.
  virtual void compute(const Kkt&) = 0;
  /// M a + J^T lambda = f, J a = c, by the matrix computed last; of all lambda the smallest in the metric of E. Where
  /// the solver reads rows (KktPattern::rows) and they were written since compute(), the matrix is still the old one, and
  /// the residual is left to the caller, who iterates.
  virtual SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) = 0;
  /// Fills what a report of the last solution costs time to know (residual, pivots, detector) where solve() left it out.
  virtual void complete(SolveReport&) {}
};

/// A method, without numbers: from the shape of a matrix it makes factorizations, as many as the caller wants to hold.
class LOCKSTEP_API LinearSolver {
 public:
  virtual ~LinearSolver();
  virtual std::string_view name() const = 0;
  /// Sizes, ordering, symbolic work; once for every set of active links.
  virtual std::unique_ptr<Factorization> analyse(const KktPattern&) const = 0;
  /// Whether it takes the rows from KktPattern::rows instead of M, J and E.
  virtual bool reads_rows() const { return false; }
};

}  // namespace lockstep
