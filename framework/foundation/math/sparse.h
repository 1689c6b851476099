// SPDX-License-Identifier: BSD-3-Clause
// Sparse matrices whose rows and columns are scaled.
#pragma once

#include <Eigen/SparseCore>

#include <lockstep/math.h>

namespace lockstep {

using SparseMat = Eigen::SparseMatrix<double>;

/// diag(left) A diag(right); without the right one diag(left) A. As a product with asDiagonal() Eigen 3.4 takes time as the square of the size.
inline SparseMat scaled(const VecX& left, SparseMat A, const VecX& right = {}) {
  for (int k = 0; k < A.outerSize(); ++k)
    for (SparseMat::InnerIterator x(A, k); x; ++x) {
      x.valueRef() *= left[x.row()];
      if (right.size() > 0) x.valueRef() *= right[x.col()];
    }
  return A;
}

}  // namespace lockstep
