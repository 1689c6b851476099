// SPDX-License-Identifier: BSD-3-Clause
// The sparse factor of a saddle-point matrix, for solutions on the constraints.
#pragma once

#include <Eigen/SparseLU>

#include <lockstep/linearization.h>

namespace lockstep {

///   | A  J^T | | x |   | f |
///   | J  -E  | | l | = | 0 |      E: proximal term for redundant rows, corrected away
class SaddleFactor {
 public:
  /// Factors A, unknowns x unknowns, with the rows J of the mechanism. `redundant`: whether rows depend on one another;
  /// E is zero otherwise. Throws SolveError for a singular matrix.
  SaddleFactor(const MechanismMatrices&, const SparseMat& A, bool redundant);
  /// x for this f: on the constraints. Throws SolveError if x is not finite, or solves the equations to less than 1e-9.
  VecX solve(const VecX& f) const;

 private:
  VecX scale_;        // of the unknowns
  SparseMat matrix_,  // without E, in scaled unknowns and rows
      sizes_;         // of its entries
  Eigen::SparseLU<SparseMat> lu_;
};

}  // namespace lockstep
