// SPDX-License-Identifier: BSD-3-Clause
// The matrices of a mechanism at rest, and whether it stays there.
#pragma once

#include <lockstep/equilibrium.h>
#include "framework/tools/rank/unknowns.h"

namespace lockstep {

/// The terms of u^T K u by their size; `size_K`: those of K, what round-off is measured by.
inline double terms_of(const SparseMat& size_K, const VecX& u) { return u.cwiseAbs().dot(size_K * u.cwiseAbs()); }

/// Motions that are orthonormal in M and diagonal in the symmetric part of K: one column each.
struct ModalBasis {
  /// Of the motions N y. A light part on a stiff spring takes no digits from the others: soft motions are solved again
  /// among themselves.
  ModalBasis(const SparseMat& M, const SparseMat& K, const SparseMat& size_K, const MatX& N);

  MatX U,              ///< in the unknowns of the matrices
      K,               ///< U^T K U: stiffnesses on its diagonal, 1/s^2
      terms;           ///< of it by their size
  bool has_potential;  ///< whether K is symmetric in these motions, up to more than round-off makes
};

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
