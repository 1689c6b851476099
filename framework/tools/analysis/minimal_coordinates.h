// SPDX-License-Identifier: BSD-3-Clause
// Minimal coordinates of a mechanism at a state: a basis of the null space of its constraints.
#pragma once

#include <vector>

#include <Eigen/Cholesky>

#include <lockstep/linearization.h>

namespace lockstep {

/// dx = N y. Columns of N are orthonormal with rotations as lengths (times MechanismMatrices::length).
struct MinimalCoordinates {
  MatX N;          ///< unknowns x degrees of freedom
  int nearly = 0;  ///< rows whose pivots lie between 1e-11 and 1e-3: near a singular configuration
};

/// Turns as lengths: what a displacement of each unknown by 1 is divided by.
VecX lengths_of(const MechanismMatrices&);

/// By a rank-revealing decomposition of J^T with rows of length 1: pivots below 1e-11 are zero (9.26). Throws ModelError
/// where rows are dependent in this pose only: their stresses change the stiffness (9.23). A row that is redundant
/// everywhere does not.
MinimalCoordinates minimal_coordinates(Dynamics&, const State&, const MechanismMatrices&);

/// Unknowns that can stand for the minimal coordinates: N = C inverse(C at these), well conditioned.
std::vector<int> independent_unknowns(const MechanismMatrices&, const MatX& N);

/// The factor of a mass matrix in minimal coordinates. Throws SolveError if it is not positive definite.
Eigen::LLT<MatX> mass_factor(const MatX& M);

}  // namespace lockstep
