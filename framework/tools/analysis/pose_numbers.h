// SPDX-License-Identifier: BSD-3-Clause
// Poses of bodies, loads of forces and reactions of joints as numbers with the names of their channels, for analyses
// without a run.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/dynamics.h>
#include <lockstep/equilibrium.h>
#include <lockstep/recorder.h>

namespace lockstep {

/// A reaction: of a joint without its drives, or of its drives, on p's body about P.
struct NamedReaction {
  std::string name, body;  ///< "A", "A.drive"; the body of P
  LinkWrench wrench;       ///< world axes
  std::string note{};      ///< "left out", of a joint without constraints; "not unique"
};

/// Of all active joints, by their names, in a state in which an equilibrium was found; rounding is zero, and a reaction that is
/// not unique has a note.
LOCKSTEP_API std::vector<std::pair<std::string, NamedReaction>> reactions_at_rest(Dynamics&, const State&,
                                                                                  const EquilibriumReport&,
                                                                                  const UniquenessReport&);

/// By which channels are evaluated in an equilibrium with these multipliers, 1 per constraint, which must outlive it: drives
/// hold their coordinates whatever the rates of their laws are, and friction holds as it was found to.
LOCKSTEP_API Dynamics dynamics_at_rest(System&, const VecX& lambda);

/// A number with the name of its channel, "crank.x" or "A.force_on_p_world_x".
struct PoseNumber {
  std::string name, unit;
  double value;
};
/// The poses of all moving bodies, and the reactions of all joints, which are zero for inactive joints.
LOCKSTEP_API std::vector<Channel> pose_channels(System&);
/// Lengths, angles and loads that forces show at rest.
LOCKSTEP_API std::vector<Channel> load_channels(System&);

/// Poses by the names of moving bodies, and reactions by the names of joints and drives, as results.
using NamedPoses = std::vector<std::pair<std::string, Pose>>;
LOCKSTEP_API NamedPoses named_poses(const System&, const State&);

}  // namespace lockstep
