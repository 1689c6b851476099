// SPDX-License-Identifier: BSD-3-Clause
// Measured runs as results have them, for chart and advise.
#pragma once

#include "framework/tools/precision/pareto.h"
#include "framework/tools/precision/work_precision.h"
#include "framework/tools/program/result.h"

namespace lockstep {

/// Method, setting, errors, cost, or why it failed.
const Fields<WorkPrecisionRun>& measured_run_fields();
/// The same with what is known of its cost.
const Fields<CostAtError>& cost_fields();
/// All runs, the references and how well they agree, what was left out.
const Fields<WorkPrecision>& measurement_fields();

}  // namespace lockstep
