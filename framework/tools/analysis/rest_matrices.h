// SPDX-License-Identifier: BSD-3-Clause
// The matrices of a mechanism at rest, and whether it stays there.
#pragma once

#include <lockstep/equilibrium.h>
#include "framework/tools/analysis/modal_basis.h"

namespace lockstep {

/// M, K and the basis of the free motions, with rotations as lengths.
struct RestMatrices {
  Unknowns at;     ///< all of the mechanism
  SparseMat M, K;  ///< masses, stiffness with the geometric one
  MatX N;          ///< free_motions()
  SparseMat
      size_K;  ///< terms of K by their size, what round-off is measured by: for each entry the largest of its pair
               ///< of bodies, and on the diagonal the largest load on its body over the length

  /// `lambda`: 1 per row. It allocates.
  RestMatrices(const Evaluation&, const VecX& lambda);

  ModalBasis modal_basis() const { return {M, K, size_K, N}; }
};

/// What the free motions N do when they are disturbed, at rest at this evaluation.
Stability judge_motions(const Evaluation&, const RestMatrices&);

}  // namespace lockstep
