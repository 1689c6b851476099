// SPDX-License-Identifier: BSD-3-Clause
// Measured runs as JSON, for chart and advise.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "framework/tools/precision/pareto.h"

namespace lockstep {

/// Method, setting, errors, cost, or why it failed.
nlohmann::ordered_json json_of(const WorkPrecisionRun&);
/// The same with what is known of its cost.
nlohmann::ordered_json json_of(const CostAtError&);
/// All runs, the references and how well they agree, what was left out.
nlohmann::ordered_json json_of(const WorkPrecision&);

}  // namespace lockstep
