// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/eigenvectors.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <lockstep/error.h>

namespace lockstep {

Eigenvectors eigenvectors(const MatX& A) {
  const Eigen::EigenSolver<MatX> solver(A);
  if (solver.info() != Eigen::Success) throw SolveError("the eigenvalues of a matrix did not converge");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SingularValues singular_values(const MatX& A) {
  const Eigen::BDCSVD<MatX> svd(A, Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace lockstep
