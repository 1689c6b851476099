// SPDX-License-Identifier: BSD-3-Clause
// Decompositions of dense matrices, compiled once: Eigen's cost seconds in each file that names them.
#pragma once

#include <lockstep/math.h>

namespace lockstep {

/// Of a symmetric matrix, ascending.
LOCKSTEP_API VecX symmetric_eigenvalues(const MatX& A);

/// The x of least norm among those with the least |A x - b|. Pivots up to `limit` times the largest count as zero; 0: those
/// of round-off.
LOCKSTEP_API VecX least_norm(const MatX& A, const VecX& b, double limit = 0);

/// Orthonormal columns that span the x with A x = 0.
LOCKSTEP_API MatX null_space(const MatX& A);

}  // namespace lockstep
