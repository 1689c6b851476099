// The matrices of a mechanism at rest, dense, and whether it stays there.
#pragma once

#include <lockstep/equilibrium.h>
#include "framework/tools/analysis/unknowns.h"

namespace lockstep {

/// M, K and the basis of the free motions, with turns as lengths.
struct RestMatrices {
  Unknowns at;   ///< all of the mechanism
  MatX M, K, N;  ///< masses, stiffness with the geometric one, and free_motions()
  MatX size_K;   ///< terms of K by their size, what round-off is measured by: for each entry the largest of its pair of
                 ///< bodies, and on the diagonal the largest load on its body over the length

  /// `lambda`: 1 per row. It allocates.
  RestMatrices(const Evaluation&, const VecX& lambda);
};

/// Free motions that are orthonormal in M and diagonal in the symmetric part of K: one column each.
struct RestMotions {
  /// A light part on a stiff spring takes no digits from the others: soft motions are solved again among themselves.
  explicit RestMotions(const RestMatrices&);

  MatX U,                     ///< in the unknowns of the matrices
      K,                      ///< U^T K U: stiffnesses on its diagonal, 1/s^2
      terms;                  ///< of it by their size
  bool has_potential = true;  ///< whether K is symmetric in these motions, up to more than round-off makes
};

/// What the free motions N do when they are disturbed, at rest at this evaluation.
Stability judge_motions(const Evaluation&, const RestMatrices&);

}  // namespace lockstep
