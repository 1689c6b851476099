#include "framework/tools/analysis/rest_motions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Eigenvalues>

#include <lockstep/newton.h>
#include "framework/tools/analysis/forces_at_rest.h"
#include "framework/tools/analysis/limits.h"
#include "framework/tools/analysis/mechanism_matrices.h"

namespace lockstep {

RestMatrices::RestMatrices(const Evaluation& e, const VecX& lambda) : at(e.system()), N(free_motions(e)) {
  const VecX turned = at.lengths().cwiseInverse();
  const auto in_lengths = [&](const SparseMat& A) { return MatX(turned.asDiagonal() * A * turned.asDiagonal()); };
  NewtonMatrix newton;
  newton.gather(e, lambda);
  M = in_lengths(mass_of(e.system(), at)), K = in_lengths(tangent_of(newton.tangents(), false, at));
  Vec6 turned_block = Vec6::Ones();
  turned_block.tail<3>() /= e.system().length();
  Triplets sizes;
  for (std::size_t p = 0; p < newton.tangents().pairs().size(); ++p) {
    const Mat6 block = turned_block.asDiagonal() * newton.tangents().K(p) * turned_block.asDiagonal();
    const auto [row, column] = newton.tangents().pairs()[p];
    at.add(row, column, Mat6::Constant(block.cwiseAbs().maxCoeff()), sizes);
  }
  size_K = at.square(sizes);
  const VecX loads = largest_loads(e, lambda);
  for (Eigen::Index i = 0; i < size_K.rows(); ++i)
    size_K(i, i) += loads[at.places()[static_cast<std::size_t>(i)] / 6] / e.system().length();
}

double rest_round_off(const RestMatrices& A, const VecX& sizes) { return kRoundOff * sizes.dot(A.size_K * sizes); }

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
    const double soft = kSlight * mu.cwiseAbs().maxCoeff();
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
  return ((K - K.transpose()).cwiseAbs().array() <= kSlight * (terms + terms.transpose()).array()).all();
}

}  // namespace lockstep
