// The sparse factor of a saddle-point matrix, for solutions on the constraints.
#pragma once

#include <Eigen/SparseLU>

#include <lockstep/linearization.h>

namespace lockstep {

///   | A  J^T | | x |   | f |
///   | J  -E  | | l | = | 0 |      E: proximal term for redundant rows, corrected away
class SaddleFactor {
 public:
  /// Factors A, unknowns x unknowns, with the rows J of the mechanism. Throws SolveError for a singular matrix.
  SaddleFactor(const MechanismMatrices&, const SparseMat& A);
  /// x for this f: on the constraints. Throws SolveError where x is not finite.
  VecX solve(const VecX& f) const;

 private:
  VecX scale_;        // of the unknowns
  SparseMat matrix_;  // without E, in scaled unknowns and rows
  Eigen::SparseLU<SparseMat> lu_;
};

}  // namespace lockstep
