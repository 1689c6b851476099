// SPDX-License-Identifier: BSD-3-Clause
// Poses, reactions and loads of forces as fields of results.
#pragma once

#include "framework/tools/analysis/pose_numbers.h"
#include "framework/tools/program/result.h"

namespace lockstep {

inline constexpr int kMostStarts = 1'000'000;  ///< of one call

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
