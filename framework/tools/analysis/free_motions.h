// The motions that the rows of a mechanism leave free in one position.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/export.h>

namespace lockstep {

/// Unknowns of a mechanism with rotations as lengths, so that all are m: their number among 6 per slot.
LOCKSTEP_API std::vector<int> unknowns_of(const System&);

/// Basis of the motions that the rows leave free, orthonormal in these unknowns: one column each (RowSpace::free).
LOCKSTEP_API MatX free_motions(const Evaluation&);

/// A motion in these unknowns, 6 per slot: m (world) and rad (slot axes).
LOCKSTEP_API VecX motion_of(const System&, const std::vector<int>& unknowns, const VecX& u);

/// Forces in these unknowns, N, so that they have the power of `f` in each motion; f: 6 per slot, N (world) and N m (slot
/// axes).
VecX forces_in(const System&, const std::vector<int>& unknowns, const VecX& f);

}  // namespace lockstep
