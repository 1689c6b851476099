// SPDX-License-Identifier: BSD-3-Clause
// Motions of a mechanism in which its masses and its stiffness are diagonal.
#pragma once

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

}  // namespace lockstep
