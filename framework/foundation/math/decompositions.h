// SPDX-License-Identifier: BSD-3-Clause
// Decompositions of dense matrices, compiled once: Eigen's cost seconds in each file that names them.
#pragma once

#include <cmath>

#include <lockstep/math.h>

namespace lockstep {

/// Of a symmetric matrix, ascending.
LOCKSTEP_API VecX symmetric_eigenvalues(const MatX& A);

/// The x of least norm among those with the least |A x - b|. Pivots up to `limit` times the largest count as zero; 0: those
/// of round-off.
LOCKSTEP_API VecX least_norm(const MatX& A, const VecX& b, double limit = 0);

/// A P = Q R, the column with the largest rest first. Q is a product of Householder reflections, stored below R.
struct LOCKSTEP_API PivotedQr {
  explicit PivotedQr(const MatX& A);
  int rank(double limit) const;        ///< pivots up to `limit` are zero
  MatX rest(Eigen::Index rank) const;  ///< the columns of Q from this one on
  double pivot(Eigen::Index k) const { return k < scale.size() ? std::abs(R(k, k)) : 0.0; }

  MatX R;                  ///< upper triangle; below it the reflections
  VecX scale;              ///< of each reflection
  Eigen::VectorXi column;  ///< of A, in each place
};
/// x <- Q x and x <- Q^T x by the reflections below R, without an allocation.
LOCKSTEP_API void apply_Q(const MatX& R, const VecX& scale, VecX& x);
LOCKSTEP_API void apply_Qt(const MatX& R, const VecX& scale, VecX& x);

/// P A = L U with the largest number of each column as its pivot.
struct LOCKSTEP_API PivotedLu {
  bool compute(MatX A);         ///< false: A is singular or not finite
  VecX solution(VecX b) const;  ///< A^-1 b

  MatX LU;             ///< L below the diagonal, which is 1
  Eigen::VectorXi to;  ///< where each row of A is
};

/// Orthonormal columns that span the x with A x = 0.
LOCKSTEP_API MatX null_space(const MatX& A);

}  // namespace lockstep
