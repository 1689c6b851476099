// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/dense.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace lockstep::dense {

int rank(const MatX& A, double threshold) {
  Eigen::JacobiSVD<MatX> svd(A);
  svd.setThreshold(threshold);
  return static_cast<int>(svd.rank());
}

VecX least_squares(const MatX& A, const VecX& b, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<MatX> decomposition(A);
  decomposition.setThreshold(threshold);
  return decomposition.solve(b);
}

MatX orthogonal(const MatX& A) { return A.householderQr().householderQ(); }

MatX null_space(const MatX& A, double threshold) {
  Eigen::FullPivLU<MatX> lu(A);
  lu.setThreshold(threshold);
  if (lu.dimensionOfKernel() == 0) return MatX(A.cols(), 0);
  const MatX kernel = lu.kernel();
  return orthogonal(kernel).leftCols(kernel.cols());
}

MatX inverse(const MatX& A) { return A.inverse(); }

MatX solve(const MatX& A, const MatX& B) { return A.partialPivLu().solve(B); }

double log_determinant(const MatX& A) { return A.partialPivLu().matrixLU().diagonal().cwiseAbs().array().log().sum(); }

std::vector<std::complex<double>> eigenvalues(const MatX& A) {
  const Eigen::VectorXcd found = A.eigenvalues();
  return {found.begin(), found.end()};
}

}  // namespace lockstep::dense
