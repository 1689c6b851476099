// SPDX-License-Identifier: BSD-3-Clause
// The cells of an atlas as numbers: CSV, JSON, lines of text.
#pragma once

#include <string>

#include "framework/tools/commands/atlas_plan.h"
#include "framework/tools/program/result.h"

namespace lockstep {

/// As CSV: a line for each run.
std::string atlas_csv(const AtlasPlan&);

/// "axes", and "maps": for each method its outcomes by the numbers of the axes, or why it is left out.
const Fields<AtlasPlan>& atlas_fields();

}  // namespace lockstep
