// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/eigenvectors.h"

#include <Eigen/Eigenvalues>

#include <lockstep/error.h>

namespace lockstep {

Eigenvectors eigenvectors(const MatX& A) {
  const Eigen::EigenSolver<MatX> solver(A);
  if (solver.info() != Eigen::Success) throw SolveError("the eigenvalues of a matrix did not converge");
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace lockstep
