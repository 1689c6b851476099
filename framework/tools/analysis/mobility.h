// Mobility: rank, freedoms and redundant rows of a mechanism in one pose, by name.
#pragma once

#include <string>
#include <vector>

#include "framework/dynamics/evaluate/dynamics.h"

namespace lockstep {

struct MobilityReport {
  int bodies = 0;                            ///< that move
  int unknowns = 0;                          ///< velocities: 6 a body, 3 a particle
  int rows = 0;                              ///< of the active links, drives included
  int rank = 0;                              ///< of the rows, in this pose
  int freedoms = 0;                          ///< unknowns - rank
  int redundant = 0;                         ///< rows - rank
  std::vector<std::string> redundant_links;  ///< links that share in a dependency of the rows
};

/// Rank by a pivoted QR of the rows, turns counted as lengths, every row made one long; threshold 1e-9. For
/// descriptions, not for runs.
LOCKSTEP_API MobilityReport mobility(Dynamics&, const State&);

}  // namespace lockstep
