// SPDX-License-Identifier: BSD-3-Clause
// Poses of bodies, loads of forces and reactions of joints as numbers with the names of their channels, for analyses
// without a run.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include "framework/tools/program/result.h"

namespace lockstep {

inline constexpr int kMostStarts = 1'000'000;  ///< of one call

/// A reaction: of a joint without its drives, or of its drives, on p's body about P.
struct NamedReaction {
  std::string name, body;  ///< "A", "A.drive"; the body of P
  LinkWrench wrench;       ///< world axes
  std::string note{};      ///< "left out", of a joint without constraints; "not unique"
};

/// Of all active joints, by their names.
std::vector<std::pair<std::string, NamedReaction>> reactions_of(const System&, const Evaluated&);

/// A number with the name of its channel, "crank.x" or "A.force_on_p_world_x".
struct PoseNumber {
  std::string name, unit;
  double value;
};
/// Those of the poses of all moving bodies and of the reactions of all joints, which are zero for inactive joints.
std::vector<PoseNumber> pose_numbers(const System&, const State&, const Evaluated&);
/// Lengths, angles and loads that forces show at rest.
std::vector<PoseNumber> force_numbers(const System&, const Inputs&);

/// Poses by the names of moving bodies, and reactions by the names of joints and drives, as results.
using NamedPoses = std::vector<std::pair<std::string, Pose>>;
NamedPoses poses_of(const System&, const State&);
inline const Fields<Pose> kPoseFields{{"position", "m", "at", &Pose::x}, {"orientation", "", "orientation", &Pose::q}};
inline const Fields<NamedReaction> kReactionFields{
    {"on", "", "on", &NamedReaction::body},
    {"force", "N", "force", [](const NamedReaction& r) { return r.wrench.force; }},
    {"moment", "N m", "moment", [](const NamedReaction& r) { return r.wrench.moment; }},
    {"note", "", "note", &NamedReaction::note}};
inline const Fields<PoseNumber> kNumberFields{{"name", "", "name", &PoseNumber::name},
                                              {"value", "", "value", &PoseNumber::value},
                                              {"unit", "", "unit", &PoseNumber::unit}};

}  // namespace lockstep
