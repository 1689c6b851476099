// The motions that the rows of a mechanism leave free in one position.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// Unknowns of a mechanism with rotations as lengths, so that all are m: their number among 6 per slot.
std::vector<int> unknowns_of(const System&);

/// Basis of the motions that the rows leave free, orthonormal in these unknowns: one column each. Pivots below 1e-9, of
/// rows of length 1, are zero.
MatX free_motions(const Evaluation&, const std::vector<int>& unknowns);

/// A motion in these unknowns, 6 per slot: m (world) and rad (slot axes).
VecX motion_of(const System&, const std::vector<int>& unknowns, const VecX& u);

/// Forces in these unknowns, N, so that they have the power of `f` in each motion; f: 6 per slot, N (world) and N m (slot
/// axes).
VecX forces_in(const System&, const std::vector<int>& unknowns, const VecX& f);

}  // namespace lockstep
