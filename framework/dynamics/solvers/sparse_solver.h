// "sparse": Eigen's LDL^T on the scalars of the quasi-definite matrix, with proximal corrections (framework/docs/solvers.md,
// sections 4, 5).
//
//   K = | M   J^T |      E' = eps E:  lambda = 0;  repeat  (a, lambda) += K^-1 (f - M a - J^T lambda, c - J a)
//       | J   -E' |
#pragma once

#include <memory>

#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

class Params;
struct TypeInfo;

/// The fallback and the cross-check: any topology, redundant rows, work as the fill of the links' graph.
///
/// smallest_pivot: every slot is eliminated before any link, so the pivot of row j is -D_j, D_j that of the Cholesky
/// factor of S + E', S = J M^-1 J^T. D_j / (S_jj + E'_j) lies in (0, 1]: the part of the row's own square that is
/// independent of the rows before it. Redundant rows leave about eps.
class LOCKSTEP_API SparseSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "sparse"; }
  /// compute() throws SolveError when the factorisation breaks down.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

}  // namespace lockstep
