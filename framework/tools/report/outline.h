// SPDX-License-Identifier: BSD-3-Clause
// The outline of a report: the parts of the mechanism, and their drawing.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include <lockstep/solid.h>
#include "framework/tools/report/frames.h"
#include "framework/tools/report/meshes.h"

namespace lockstep::report {

/// Bodies with their solids, markers, joints with their drawings, forces. Bodies and markers are referred to by
/// their numbers in System::bodies() and System::markers(), meshes by those in the page's list.
nlohmann::ordered_json outline_of(const Frames&, const std::vector<Solid>&, const std::vector<Look>&, Meshes&);

/// The drawing of a joint in addition to the symbol of its mask: {"curves": [{"pair":, "side": "p" or "s", "points": [x, y, z,
/// ...], "closed":}], ...}, in the axes of a marker; an empty object for most.
nlohmann::ordered_json drawing_of(const Lock&, std::pair<double, double> path_range);

}  // namespace lockstep::report
