// Masses, stiffness and free motions of a mechanism at rest, as dense matrices.
#pragma once

#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// M, K and the basis of the free motions, in the unknowns of the mechanism with rotations as lengths (unknowns_of()).
struct RestMatrices {
  std::vector<int> at;  ///< of each unknown: its number among 6 per slot
  MatX M, K, N;         ///< masses, stiffness with the geometric one, and free_motions()
  MatX size_K;          ///< terms of K by their size, what round-off is measured by: for each entry the largest of its
                        ///< pair of bodies, and on the diagonal the largest load on its body over the length

  /// `lambda`: 1 per row. It allocates.
  RestMatrices(const Evaluation&, const VecX& lambda);
};

}  // namespace lockstep
