// How `lockstep check` says which rows depend on which.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lockstep/analysis.h>

namespace lockstep {

/// "A, B and C", or the first of them "and 7 more".
std::string first_of(const std::vector<std::string>& names);
/// A line for what is too many, and one for what nearly is: "    A.z, B.z and C.z: 1 too many".
std::string words_of(const Dependency&);
/// The same as data.
nlohmann::ordered_json dependencies_json(const MobilityReport&);

}  // namespace lockstep
