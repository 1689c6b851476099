// SPDX-License-Identifier: BSD-3-Clause
// The maps of an atlas as a picture.
#pragma once

#include <string>

#include "framework/tools/charts/map_grid.h"
#include "framework/tools/commands/atlas_plan.h"

namespace lockstep {

/// A map for each method that runs. `of`: "status", "error" or "energy"; `reference`: the methods of the references.
MapGridSpec atlas_picture(const AtlasPlan&, const std::string& reference, const std::string& of);

}  // namespace lockstep
