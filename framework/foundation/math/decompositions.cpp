// SPDX-License-Identifier: BSD-3-Clause
#include "framework/foundation/math/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace lockstep {

namespace {
using Orthogonal = Eigen::CompleteOrthogonalDecomposition<MatX>;
}

VecX symmetric_eigenvalues(const MatX& A) {
  return Eigen::SelfAdjointEigenSolver<MatX>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

VecX least_norm(const MatX& A, const VecX& b, double limit) {
  Orthogonal factor;
  if (limit > 0) factor.setThreshold(limit);
  factor.compute(A);
  return factor.solve(b);
}

MatX null_space(const MatX& A) {
  const Orthogonal factor(A);
  return factor.colsPermutation() * MatX(factor.matrixZ().adjoint().rightCols(A.cols() - factor.rank()));
}

}  // namespace lockstep
