// SPDX-License-Identifier: BSD-3-Clause
// Eigenvectors of dense matrices, compiled once: Eigen's solvers cost seconds in each file that names them.
#pragma once

#include <lockstep/math.h>

namespace lockstep {

/// A x = l x.
struct Eigenvectors {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< a column for each value
};
/// Throws SolveError if the iteration does not converge.
Eigenvectors eigenvectors(const MatX& A);

}  // namespace lockstep
