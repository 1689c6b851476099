// SPDX-License-Identifier: BSD-3-Clause
// The mobility of a scene, for the command `check`.
#pragma once

#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/kinematics.h>
#include "framework/tools/program/result.h"
#include "framework/tools/rank/branch_point.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {

/// Of a start that is assembled, as a run begins.
struct MobilityFindings {
  MobilityReport mobility;  ///< constraints as solved; degrees of freedom in space, unless the scene asks for a plane
  NearRows near;
  UniquenessReport reactions;
  BranchPoint position;
  std::vector<std::string> branches;                    ///< the motions that leave a branch point
  std::string position_words;                           ///< "" in a regular one
  NearlyRedundant choice = NearlyRedundant::automatic;  ///< as the run requests
  std::vector<std::string> columns_not_unique;          ///< recorded columns of reactions that are not unique
  DriveReport moves;
  std::vector<std::string> laws;  ///< joints whose laws move a mechanism without degrees of freedom and drives
  std::string plane;        ///< "z": its normal; "" in space
  std::string error;        ///< why a run would not start; "" if it would,
  int exit_code = kExitOk;  ///< and that of the run
};
/// Counted at the assembled start: one typed with eight digits leaves a loop no degree of freedom. A start that cannot
/// be assembled is used as typed, and `error` is set.
MobilityFindings mobility_of(Dynamics&, Mechanism&, const State& typed);

/// As a result.
const Fields<MobilityFindings>& mobility_fields();

}  // namespace lockstep
