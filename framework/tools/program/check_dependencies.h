// SPDX-License-Identifier: BSD-3-Clause
// How `lockstep check` says which rows depend on which, and which reactions are not unique.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lockstep/analysis.h>
#include <lockstep/scene.h>
#include <lockstep/uniqueness.h>
#include "framework/tools/rank/doubts.h"

namespace lockstep {

/// A line for what is too many: "    A.z, B.z and C.z: 1 too many".
std::string words_of(const Dependency&);
/// A line for rows that nearly depend on one another, and what was decided: "  nearly redundant    ...".
std::string words_of(const NearDependency&, NearlyRedundant);
/// The same as a finding.
Finding finding_of(const NearDependency&, NearlyRedundant);
/// The same as data.
nlohmann::ordered_json near_json(const std::vector<NearDependency>&, NearlyRedundant);
/// Lines for the reactions that are not unique, and for the recorded columns among them; "" where all are unique.
std::string words_of(const UniquenessReport&, const RunSettings&);
/// Names of the recorded columns that hold reactions which are not unique.
std::vector<std::string> columns_not_unique(const RunSettings&, const UniquenessReport&);
/// Dependencies as data.
nlohmann::ordered_json dependencies_json(const MobilityReport&);

}  // namespace lockstep
