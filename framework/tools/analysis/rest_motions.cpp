#include "framework/tools/analysis/rest_motions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Eigenvalues>

#include "framework/tools/analysis/mechanism_matrices.h"

namespace lockstep {
namespace {

constexpr double kRestRoundOff = 1e-12;  // of the terms of u^T K u by their size
constexpr double kSoft = 1e-6;           // of the stiffest of a level: solved again without it

}  // namespace

double rest_round_off(const RestMatrices& A, const VecX& sizes) { return kRestRoundOff * sizes.dot(A.size_K * sizes); }

RestMotions rest_motions(const RestMatrices& A) {
  const Eigen::Index n = A.N.cols();
  MatX all(A.N.rows(), n);
  Eigen::Index found = 0;
  // An eigenvector of a level errs by round-off of the stiffest motion over the distance to it, which adds the square of
  // that to u^T K u.
  for (MatX level = A.N; level.cols() > 0;) {
    const MatX K = level.transpose() * A.K * level, M = level.transpose() * A.M * level;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(0.5 * (K + K.transpose()), M);
    const VecX& mu = eigen.eigenvalues();
    const MatX motions = level * eigen.eigenvectors();
    const double soft = kSoft * mu.cwiseAbs().maxCoeff();
    std::vector<Eigen::Index> again;
    bool zero = true;
    for (Eigen::Index i = 0; i < mu.size(); ++i) {
      zero = zero && std::abs(mu[i]) <= rest_round_off(A, motions.col(i).cwiseAbs());
      if (std::abs(mu[i]) < soft) again.push_back(i);
    }
    if (zero) again.clear();
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      if (!std::ranges::binary_search(again, i)) all.col(found++) = motions.col(i);
    level = motions(Eigen::all, again).eval();
  }
  VecX stiffness(n), bound(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const VecX u = all.col(i);
    const double mass = u.dot(A.M * u);
    stiffness[i] = u.dot(A.K * u) / mass;
    bound[i] = rest_round_off(A, u.cwiseAbs()) / mass;
  }
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, {}, [&](Eigen::Index i) { return stiffness[i]; });
  return {all(Eigen::all, order), stiffness(order), bound(order)};
}

bool has_potential(const RestMatrices& A, const RestMotions& m) {
  const MatX K = m.U.transpose() * A.K * m.U, sizes = m.U.cwiseAbs();
  const MatX terms = sizes.transpose() * A.size_K * sizes;
  return ((K - K.transpose()).cwiseAbs().array() <= kFlat * (terms + terms.transpose()).array()).all();
}

}  // namespace lockstep
