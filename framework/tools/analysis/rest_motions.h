// The free motions of a mechanism at rest, each with the stiffness that holds it and the round-off of that.
#pragma once

#include <lockstep/equilibrium.h>
#include "framework/tools/analysis/rest_matrices.h"

namespace lockstep {

/// Free motions that are orthonormal in M and diagonal in the symmetric part of K: one column each, by rising stiffness.
struct RestMotions {
  MatX U;          ///< in the unknowns of RestMatrices
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
