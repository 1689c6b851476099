// SPDX-License-Identifier: BSD-3-Clause
#include "framework/foundation/math/decompositions.h"

#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace lockstep {

namespace {

// x <- (1 - scale v v^T) x with v = (0, 1, essential part): Eigen's product allocates for each reflection.
void reflect(const MatX& R, double scale, Eigen::Index k, VecX& x) {
  const auto essential = R.col(k).tail(x.size() - k - 1);
  auto rest = x.tail(x.size() - k - 1);
  const double s = scale * (x[k] + essential.dot(rest));
  x[k] -= s;
  rest -= s * essential;
}

}  // namespace

PivotedQr::PivotedQr(const MatX& A) : R(A), column(A.cols()) {
  std::iota(column.begin(), column.end(), 0);
  if (A.size() == 0) return;
  const Eigen::ColPivHouseholderQR<MatX> qr(A);
  R = qr.matrixQR(), scale = qr.hCoeffs(), column = qr.colsPermutation().indices();
}

int PivotedQr::rank(double limit) const {
  int n = 0;
  while (pivot(n) > limit) ++n;
  return n;
}

MatX PivotedQr::rest(Eigen::Index rank) const {
  MatX columns(R.rows(), R.rows() - rank);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    VecX x = VecX::Unit(R.rows(), rank + k);
    apply_Q(R, scale, x);
    columns.col(k) = x;
  }
  return columns;
}

void apply_Q(const MatX& R, const VecX& scale, VecX& x) {
  for (Eigen::Index k = scale.size() - 1; k >= 0; --k) reflect(R, scale[k], k, x);
}
void apply_Qt(const MatX& R, const VecX& scale, VecX& x) {
  for (Eigen::Index k = 0; k < scale.size(); ++k) reflect(R, scale[k], k, x);
}

VecX symmetric_eigenvalues(const MatX& A) {
  return Eigen::SelfAdjointEigenSolver<MatX>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

VecX least_norm(const MatX& A, const VecX& b, double limit) {
  Eigen::CompleteOrthogonalDecomposition<MatX> factor;
  if (limit > 0) factor.setThreshold(limit);
  factor.compute(A);
  return factor.solve(b);
}

bool PivotedLu::compute(MatX A) {
  LU = std::move(A);
  to = Eigen::PartialPivLU<Eigen::Ref<MatX>>(LU).permutationP().indices();
  return LU.allFinite() && (LU.diagonal().array() != 0).all();
}

VecX PivotedLu::solution(VecX b) const {
  b = Eigen::PermutationMatrix<Eigen::Dynamic>(to) * b;
  LU.triangularView<Eigen::UnitLower>().solveInPlace(b);
  LU.triangularView<Eigen::Upper>().solveInPlace(b);
  return b;
}

MatX null_space(const MatX& A) {
  const PivotedQr qr(A.transpose());
  const double zero = std::numeric_limits<double>::epsilon() * static_cast<double>(qr.scale.size()) * qr.pivot(0);
  return qr.rest(qr.rank(zero));
}

}  // namespace lockstep
