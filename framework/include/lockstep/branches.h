// SPDX-License-Identifier: BSD-3-Clause
// Branches: the different ways in which a mechanism can be assembled.
#pragma once

#include <string>
#include <vector>

#include <lockstep/state.h>

namespace lockstep {

class Dynamics;

/// A way in which the mechanism fits together.
struct AssemblyBranch {
  State state;          ///< at rest, in the slots' own coordinates
  int found = 0;        ///< how many starts led to it
  /// Of the branch itself: above 0 where parts that fold onto each other come loose, though the start has none. Such
  /// positions are not told apart: one stands for all of as many freedoms.
  int freedoms = 0;
  double distance = 0;  ///< from the first branch: largest distance of a mass centre, or turn times System::length(), m
  std::string farthest;  ///< the body of that distance
};

/// What was found from many starts.
struct BranchReport {
  int starts = 0,                        ///< tried, the one given included
      failed = 0;                        ///< that led nowhere
  std::vector<AssemblyBranch> branches;  ///< the one of the start given first, then by their distance from it
};

/// How branches are looked for.
struct BranchOptions {
  int starts = 200;    ///< random ones
  unsigned seed = 1;   ///< of their numbers
  double same = 1e-6;  ///< positions nearer to one another than this share of System::length() are one branch
};

/// Assembles the mechanism, at the time of the state, from this state and from many random poses of all bodies: each
/// somewhere within the mechanism's size about where it is, turned any way (in a plane, about its normal). Two results
/// are one branch where all bodies are in the same pose. Throws ModelError for a mechanism with freedoms, whose
/// assemblies have no number, naming what to drive; AssemblyError where the state given does not assemble.
LOCKSTEP_API BranchReport find_branches(Dynamics&, const State&, const BranchOptions& options = {});

}  // namespace lockstep
