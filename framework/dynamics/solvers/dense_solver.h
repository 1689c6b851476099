// "dense": rank-revealing QR; the referee for small systems.
//
//   M = L L^T,  B = E^-1/2 J L^-T (m x n):   a = M^-1 f + L^-T y,  y = B^+ E^-1/2 (c - J M^-1 f),
//   lambda = E^-1/2 mu,  B^T mu = -y,  |mu| minimal: of all lambda the one with the smallest sum E_j lambda_j^2.
// Where the rows contradict one another, a minimises sum (c - J a)_j^2 / E_j, as the proximal iteration does.
#pragma once

#include <memory>

#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

class Params;
struct TypeInfo;

/// Work grows with the cube of the rows. SolveReport::rank is the rank of J; smallest_pivot: of the rows in the order
/// of the QR, the smallest part of a row's own square (metric of M^-1) that is independent of the rows before it.
class LOCKSTEP_API DenseSolver final : public LinearSolver {
 public:
  static TypeInfo info();
  static std::unique_ptr<LinearSolver> make(const Params&);

  std::string_view name() const override { return "dense"; }
  /// compute() throws SolveError: a mass block that is not positive definite, by its slot.
  std::unique_ptr<Factorization> analyse(const KktPattern&) const override;
};

}  // namespace lockstep
