// SPDX-License-Identifier: BSD-3-Clause
// The cells of an atlas as numbers: a CSV file, JSON, lines of text.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/tools/commands/atlas_plan.h"

namespace lockstep {

/// Writes a line for each run. Throws FileError.
void write_atlas_cells(const std::string& file, const AtlasPlan&);

/// "axes", and "maps": for each method its outcomes by the numbers of the axes, or why it is left out.
nlohmann::ordered_json atlas_json(const AtlasPlan&);

/// Prints a line for each method: how many of its runs had which outcome.
void print_atlas_panels(const AtlasPlan&);

}  // namespace lockstep
