// SPDX-License-Identifier: BSD-3-Clause
// Branches: the different ways in which a mechanism can be assembled.
#pragma once

#include <string>
#include <vector>

#include <lockstep/state.h>

namespace lockstep {

class Dynamics;

/// One assembly of the mechanism.
struct AssemblyBranch {
  State state;    ///< at rest, in the slots' own coordinates
  int found = 0;  ///< number of starts that led to it
  /// Degrees of freedom of the branch: above 0 if parts fold onto each other and come free, though the start has none.
  /// One branch then represents all positions with as many degrees of freedom.
  int freedoms = 0;
  double distance = 0;   ///< from the first branch: of a centre of mass, or rotation times System::length(), m
  std::string farthest;  ///< the body with that distance
};

/// The branches found from many starts.
struct BranchReport {
  int starts = 0,                        ///< all of them, the given one included
      failed = 0;                        ///< those that do not assemble
  std::vector<AssemblyBranch> branches;  ///< that of the given start first, then by their distance from it
};

/// Options of the search.
struct BranchOptions {
  int starts = 200;    ///< random ones
  unsigned seed = 1;   ///< of the random numbers
  double same = 1e-6;  ///< positions closer than this share of System::length() are one branch
};

/// Assembles the mechanism, at the time of the state, from this state and from many random poses. Each body is moved by
/// up to the size of the mechanism and rotated at random (in a plane, about its normal). Two results are one branch if
/// all bodies have the same pose. Throws ModelError, naming coordinates to drive, for a mechanism with degrees of
/// freedom, and AssemblyError if the given state does not assemble.
LOCKSTEP_API BranchReport find_branches(Dynamics&, const State&, const BranchOptions& options = {});

}  // namespace lockstep
