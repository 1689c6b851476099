// SPDX-License-Identifier: BSD-3-Clause
// Which constraints nearly depend on others, and which reactions are not unique.
#pragma once

#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/scene.h>
#include "framework/tools/program/result.h"
#include "framework/tools/rank/doubts.h"

namespace lockstep {

/// Adds a finding for constraints that nearly depend on one another, with what was decided.
void note_near(const std::vector<NearDependency>&, NearlyRedundant);
/// The same as a result.
using DecidedNear = std::pair<NearDependency, NearlyRedundant>;
std::vector<DecidedNear> decided(const std::vector<NearDependency>&, NearlyRedundant);
/// "held", "free", "reported" or "undecided".
std::string decision(const NearDependency&, NearlyRedundant);
inline const Fields<DecidedNear> kNearFields{
    {"rows", "", "", [](const DecidedNear& n) { return n.first.rows; }},
    {"nearly", "", "", [](const DecidedNear& n) { return n.first.nearly; }},
    {"singular_value", "", "", [](const DecidedNear& n) { return n.first.singular_value; }},
    {"in_passing", "", "", [](const DecidedNear& n) { return n.first.in_passing; }},
    {"decided", "", "", [](const DecidedNear& n) { return decision(n.first, n.second); }},
    {"undecided", "", "", [](const DecidedNear& n) { return n.first.undecided; }},
    {"needed", "", "", [](const DecidedNear& n) { return n.first.needed; }},
    {"violation", "m", "", [](const DecidedNear& n) { return n.first.violation; }},
    {"left_out", "", "", [](const DecidedNear& n) { return n.first.left_out; }}};
/// The names of constraints, grouped by joint.
std::string grouped_text(const Json& constraints);
/// Constraints that depend on one another, as a table.
inline const Fields<Dependency> kDependencyFields{{"rows", "", "constraints", &Dependency::rows, grouped_text},
                                                  {"too_many", "", "redundant", &Dependency::too_many},
                                                  {"nearly", "", "nearly redundant", &Dependency::nearly},
                                                  {"pivot", "", "", &Dependency::pivot}};
/// Adds the finding that reactions are not unique, if some are not.
void note_not_unique(const UniquenessReport&);

}  // namespace lockstep
