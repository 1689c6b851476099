// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/saddle_factor.h"

#include <limits>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/math/sparse.h"
#include "framework/tools/analysis/minimal_coordinates.h"

namespace lockstep {

namespace {

// Of the largest number of A: below what regular rows leave in the Schur complement, above its round-off.
constexpr double kProximal = 1e-10;

}  // namespace

SaddleFactor::SaddleFactor(const MechanismMatrices& m, const SparseMat& A, bool redundant)
    : scale_(lengths_of(m).cwiseInverse()) {
  const Eigen::Index n = A.rows(), rows = m.J.rows();
  const SparseMat scaled = lockstep::scaled(scale_, A, scale_);
  const SparseMat Jt = lockstep::scaled(scale_, m.J.transpose());
  double size = n > 0 ? VecX(scaled.diagonal()).cwiseAbs().maxCoeff() : 0;
  if (size == 0) size = 1;

  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < n; ++j)
    for (SparseMat::InnerIterator it(scaled, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double length = Jt.col(row).norm(), to = length > 0 ? size / length : 0.0;
    for (SparseMat::InnerIterator it(Jt, row); it; ++it) {
      entries.emplace_back(it.row(), n + row, to * it.value());
      entries.emplace_back(n + row, it.row(), to * it.value());
    }
  }
  matrix_.resize(n + rows, n + rows);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  sizes_ = matrix_.cwiseAbs();
  for (Eigen::Index row = n; redundant && row < n + rows; ++row) entries.emplace_back(row, row, -kProximal * size);
  SparseMat with_proximal(n + rows, n + rows);
  with_proximal.setFromTriplets(entries.begin(), entries.end());
  lu_.compute(with_proximal);
  if (lu_.info() != Eigen::Success)
    throw SolveError("the saddle-point matrix of the linear equations has no factors: " + lu_.lastErrorMessage());
}

// Corrected as long as that helps: a long loop of joints lets the proximal term go slowly.
VecX SaddleFactor::solve(const VecX& f) const {
  if (f.isZero(0)) return f;
  const Eigen::Index n = scale_.size();
  VecX b = VecX::Zero(matrix_.rows());
  b.head(n) = scale_.cwiseProduct(f);
  VecX x = VecX::Zero(b.size()), left = b;
  double error = 1;  // relative to the largest terms
  while (error > std::numeric_limits<double>::epsilon()) {
    const VecX next = x + lu_.solve(left), next_left = b - matrix_ * next;
    const double now = next_left.lpNorm<Eigen::Infinity>() / (b.cwiseAbs() + sizes_ * next.cwiseAbs()).maxCoeff();
    if (!(now < 0.7 * error)) break;
    x = next, left = next_left, error = now;
  }
  if (!(error <= kNegligible))
    throw SolveError("the sparse matrix of the linear equations is ill-conditioned: the relative residual is " +
                     std::to_string(error) + "; use a dense solution (dense_limit)");
  return scale_.cwiseProduct(x.head(n));
}

}  // namespace lockstep
