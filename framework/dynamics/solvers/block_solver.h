// "block": LDL^T in blocks over the graph of slots and links, leaves first, with proximal corrections (framework/docs/solvers.md,
// sections 4, 5).
//
//   | M   J^T |      E' = eps E:  lambda = 0;  repeat  (a, lambda) += K^-1 (f - M a - J^T lambda, c - J a)
//   | J   -E' |
#pragma once

#include <memory>

#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

class Params;
struct TypeInfo;

/// Linear in the number of bodies on trees of any kind, hubs too; no allocation after analyse. The same factorisation
/// serves implicit methods, whose mass matrix couples bodies (dynamics/evaluate/implicit.h).
///
/// smallest_pivot: of a row, against its scale E_j: the part of its square that is independent of the rows before it.
/// Redundant rows leave about eps.
class LOCKSTEP_API BlockSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "block"; }
  /// compute() throws SolveError for a body without mass or inertia.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
  /// Multiplications of one factorisation.
  static long multiplications(const KktPattern&);
};

}  // namespace lockstep
