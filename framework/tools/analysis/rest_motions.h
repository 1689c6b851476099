// The free motions of a mechanism at rest, each with the stiffness that holds it and the round-off of that, from dense
// matrices.
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

/// Free motions that are orthonormal in M and diagonal in the symmetric part of K: one column each, by rising stiffness.
struct RestMotions {
  MatX U;          ///< in these unknowns
  VecX stiffness,  ///< u^T K u, 1/s^2
      bound;       ///< of each: what is below is round-off, 1/s^2
};

/// A light part on a stiff spring takes no digits from the others: soft motions are solved again among themselves.
RestMotions rest_motions(const RestMatrices&);

/// What these motions do when they are disturbed, at rest at this evaluation.
Stability judge_motions(const Evaluation&, const RestMatrices&);

/// What round-off may leave of u^T K u where u^T M u = 1, 1/s^2. `sizes`: the unknowns of u by their size.
double rest_round_off(const RestMatrices&, const VecX& sizes);

/// Whether the loads have a potential: whether K is symmetric in these motions, up to more than round-off makes.
bool has_potential(const RestMatrices&, const RestMotions&);

}  // namespace lockstep
