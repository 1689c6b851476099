// SPDX-License-Identifier: BSD-3-Clause
// The results of work_precision as CSV and as charts.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/precision/pareto.h"
#include "framework/tools/charts/chart_grid.h"

namespace lockstep {

/// As CSV, one line per run: its method, setting, errors and cost, whether it is valid, whether it is on the Pareto
/// front of position error against CPU time, and the reason of a failure.
LOCKSTEP_API std::string runs_text(const WorkPrecision&);

/// What distinguishes the curves of a chart; in all else they equal its base.
enum class ChartBy { integrator, formulation, stabilization, solver };
LOCKSTEP_API std::string to_string(ChartBy);
/// The value of a run, and all values of the runs in the order of their first.
LOCKSTEP_API std::string value_of(const WorkPrecisionRun&, ChartBy);
LOCKSTEP_API std::vector<std::string> values_of(const WorkPrecision&, ChartBy);

/// The four errors over the cost, one panel each, one curve per integrator.
LOCKSTEP_API GridSpec integrators_chart(const WorkPrecision&, const std::string& title, const WorkPrecisionRun& base,
                                        CostKind);
/// Position and reaction error over CPU time, one row per integrator, one curve per value of `by`.
LOCKSTEP_API GridSpec forms_chart(const WorkPrecision&, const std::string& title, const WorkPrecisionRun& base,
                                  ChartBy by, const std::vector<std::string>& integrators);

}  // namespace lockstep
