// SPDX-License-Identifier: BSD-3-Clause
// The cells of an atlas as numbers: a CSV file, JSON, lines of text.
#pragma once

#include <string>
#include <vector>


#include "framework/tools/commands/atlas_plan.h"
#include "framework/tools/program/result.h"

namespace lockstep {

/// Writes a line for each run. Throws FileError.
void write_atlas_cells(const std::string& file, const AtlasPlan&);

/// "axes", and "maps": for each method its outcomes by the numbers of the axes, or why it is left out.
const Fields<AtlasPlan>& atlas_fields();

}  // namespace lockstep
