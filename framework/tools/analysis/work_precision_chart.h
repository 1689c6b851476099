// The results of work_precision as lines of a file and as pictures.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/analysis/pareto.h"
#include "framework/tools/charts/chart_grid.h"

namespace lockstep {

/// One line a run with names in words, header with units; whether it counts, whether it is on the front of position
/// error against CPU time; failures with their reason. Throws FileError.
LOCKSTEP_API void write_runs(const std::string& file, const WorkPrecision&);

/// "18 combinations, such as rk4, quaternion, project, schur: why", a line a reason.
LOCKSTEP_API std::vector<std::string> unsuited_lines(const WorkPrecision&);

/// What distinguishes the curves of a picture; in all else they are as its base.
enum class ChartBy { integrator, formulation, stabilization, solver };
LOCKSTEP_API std::string to_string(ChartBy);
/// The run's value of it, and all that were charted, in the order of their first run.
LOCKSTEP_API std::string value_of(const WorkPrecisionRun&, ChartBy);
LOCKSTEP_API std::vector<std::string> values_of(const WorkPrecision&, ChartBy);

/// The four errors over the cost, one panel each, a curve an integrator in the base's form.
LOCKSTEP_API GridSpec integrators_chart(const WorkPrecision&, const std::string& title, const WorkPrecisionRun& base,
                                        CostKind);
/// Position and reaction error over CPU time, a row an integrator of `integrators`, a curve a value of `by`.
LOCKSTEP_API GridSpec forms_chart(const WorkPrecision&, const std::string& title, const WorkPrecisionRun& base,
                                  ChartBy by, const std::vector<std::string>& integrators);

}  // namespace lockstep
