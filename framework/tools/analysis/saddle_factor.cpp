#include "framework/tools/analysis/saddle_factor.h"

#include <cmath>
#include <limits>

#include <lockstep/error.h>

namespace lockstep {

namespace {

// Of the largest number of A: below what regular rows leave in the Schur complement, above its round-off.
constexpr double kProximal = 1e-10;

}  // namespace

SaddleFactor::SaddleFactor(const MechanismMatrices& m, const SparseMat& A, bool redundant) {
  const double proximity = redundant ? kProximal : 0.0;
  const Eigen::Index n = A.rows(), rows = m.J.rows();
  scale_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
    scale_[i] = m.unknowns[static_cast<std::size_t>(i)].velocity < 3 ? 1.0 : 1.0 / m.length;
  const SparseMat scaled = scale_.asDiagonal() * A * scale_.asDiagonal();
  const SparseMat Jt = scale_.asDiagonal() * SparseMat(m.J.transpose());
  double size = 0;
  for (Eigen::Index i = 0; i < n; ++i) size = std::max(size, std::abs(scaled.coeff(i, i)));
  if (size == 0) size = 1;

  std::vector<Eigen::Triplet<double>> entries, proximal;
  for (Eigen::Index j = 0; j < n; ++j)
    for (SparseMat::InnerIterator it(scaled, j); it; ++it) entries.emplace_back(it.row(), j, it.value());
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double length = Jt.col(row).norm(), to = length > 0 ? size / length : 0.0;
    for (SparseMat::InnerIterator it(Jt, row); it; ++it) {
      entries.emplace_back(it.row(), n + row, to * it.value());
      entries.emplace_back(n + row, it.row(), to * it.value());
    }
    proximal.emplace_back(n + row, n + row, -proximity * size);
  }
  matrix_.resize(n + rows, n + rows);
  matrix_.setFromTriplets(entries.begin(), entries.end());
  sizes_ = matrix_.cwiseAbs();
  SparseMat with_proximal(n + rows, n + rows);
  entries.insert(entries.end(), proximal.begin(), proximal.end());
  with_proximal.setFromTriplets(entries.begin(), entries.end());
  lu_.compute(with_proximal);
  if (lu_.info() != Eigen::Success)
    throw SolveError("the saddle-point matrix of the linear equations has no factors: " + lu_.lastErrorMessage());
}

VecX SaddleFactor::solve(const VecX& f) const {
  constexpr int kCorrections = 40;  // a long loop of joints lets the proximal term go slowly
  constexpr double kEnough = 4 * std::numeric_limits<double>::epsilon(), kRefused = 1e-9;
  const Eigen::Index n = scale_.size();
  VecX b = VecX::Zero(matrix_.rows());
  b.head(n) = scale_.cwiseProduct(f);
  VecX x = lu_.solve(b), left = b - matrix_ * x;
  // The residual of each equation, relative to its largest terms.
  const auto error = [&] {
    const VecX terms = b.cwiseAbs() + sizes_ * x.cwiseAbs();
    const double most = terms.maxCoeff();
    return most > 0 ? left.cwiseAbs().cwiseQuotient(terms.cwiseMax(1e-6 * most)).maxCoeff() : 0.0;
  };
  double now = error();
  for (int k = 0; k < kCorrections && now > kEnough; ++k) {
    const VecX before = x;
    x += lu_.solve(left);
    left = b - matrix_ * x;
    const double next = error();
    if (!(next < 0.7 * now)) {
      if (!(next < now)) x = before;
      now = std::min(now, next);
      break;
    }
    now = next;
  }
  if (!x.allFinite() || !(now <= kRefused))
    throw SolveError("the sparse matrix of the linear equations is too badly conditioned: a solution leaves " +
                     std::to_string(now) + " of its terms; ask for a dense solution (dense_limit)");
  return scale_.cwiseProduct(x.head(n));
}

}  // namespace lockstep
