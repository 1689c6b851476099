// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/analysis/modal_basis.h"

#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "framework/foundation/math/limits.h"

namespace lockstep {

// An eigenvector of a level errs by round-off of the stiffest motion over the distance to it, which adds the square of
// that to u^T K u.
ModalBasis::ModalBasis(const SparseMat& M, const SparseMat& of, const SparseMat& size_K, const MatX& N)
    : U(N.rows(), N.cols()) {
  Eigen::Index found = 0;
  for (MatX level = N; level.cols() > 0;) {
    const MatX K_level = level.transpose() * (of * level), M_level = level.transpose() * (M * level);
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> eigen(0.5 * (K_level + K_level.transpose()), M_level);
    const VecX& mu = eigen.eigenvalues();
    const MatX motions = level * eigen.eigenvectors();
    const double soft = kSlight * mu.cwiseAbs().maxCoeff();
    bool zero = true;
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      zero = zero && std::abs(mu[i]) <= kRoundOff * terms_of(size_K, motions.col(i));
    std::vector<Eigen::Index> again;
    for (Eigen::Index i = 0; i < mu.size(); ++i)
      if (!zero && std::abs(mu[i]) < soft)
        again.push_back(i);
      else
        U.col(found++) = motions.col(i);
    level = motions(Eigen::all, again).eval();
  }
  K = U.transpose() * (of * U), terms = U.cwiseAbs().transpose() * (size_K * U.cwiseAbs());
  has_potential = ((K - K.transpose()).cwiseAbs().array() <= kSlight * (terms + terms.transpose()).array()).all();
}

}  // namespace lockstep
