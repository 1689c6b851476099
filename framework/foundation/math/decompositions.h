// Decompositions of dense matrices, compiled once: Eigen's cost seconds in each file that names them.
#pragma once

#include <lockstep/export.h>
#include <lockstep/math.h>

namespace lockstep {

/// A = U diag(values) V^T of a square A.
struct SingularValues {
  VecX values;  ///< largest first
  MatX V;       ///< orthogonal; a column for each value
};
LOCKSTEP_API SingularValues singular_values(const MatX& A);

/// The x of least norm among those with the least |A x - b|. Pivots up to `limit` times the largest count as zero; 0: those
/// of round-off.
LOCKSTEP_API VecX least_norm(const MatX& A, const VecX& b, double limit = 0);

/// Orthonormal columns that span the x with A x = 0.
LOCKSTEP_API MatX null_space(const MatX& A);

/// A x = l x.
struct Eigenvectors {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;  ///< a column for each value
};
/// Throws SolveError where the iteration does not converge.
LOCKSTEP_API Eigenvectors eigenvectors(const MatX& A);

}  // namespace lockstep
