// SPDX-License-Identifier: BSD-3-Clause
// SceneBenchmark: what `chart` and `advise` measure: the work-precision data of a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/tools/precision/pareto.h"
#include "framework/tools/precision/work_precision.h"
#include "framework/tools/program/options.h"
#include "framework/tools/program/progress.h"

namespace lockstep {

struct SceneBenchmark {
  std::string title;
  Trajectory trajectory;
  WorkPrecisionOptions options;
  WorkPrecisionRun base;               ///< the scene's own combination
  bool imposed = false;                ///< laws prescribe the whole motion: nothing is left to integrate
  std::vector<std::string> remarks{};  ///< what is left out from the beginning, and why
};

/// The scene's own integrator, formulation, stabilisation and solver come first and are the base; what --integrators,
/// --formulations, --stabilisations and --solvers name replaces the full lists. `loaded` must outlive it. Throws
/// UsageError for invalid options, SceneError for a scene without an end.
SceneBenchmark benchmark_of(const Loaded& loaded, const Arguments&);

/// Adaptive methods of the registry. Those with the keys of the settings' own integrator that they know come before
/// other choices of keys; then implicit or explicit ones as requested, then the higher order. `registry` must outlive
/// them.
std::vector<MethodChoice> references_of(const RunSettings&, const Registry& registry, bool implicit);

// Options of chart, advise and atlas.
inline constexpr Option kIntegrators{"--integrators", "A,B",
                                     "integrators, with keys if needed: rk4,dopri5:fixed=true; default: all"},
    kUntil{"--until", "TIME", "end of the runs, s"},
    kBudget{"--budget", "TIME", "CPU time for all runs together; default 60 s"},
    kFolder{"--out", "DIR", "folder for CSV and pictures; default: LOCKSTEP_OUTPUT or the current folder"};
/// What chart and advise take.
Options measuring_options();
/// The same arguments; in space if --formulations names quaternion, which no plane has.
Arguments measuring_arguments(Arguments);

/// The base of files of --out, "DIR/four_bar" + `ending`; its table can be written. Throws FileError.
std::string base_of(const Arguments&, const char* ending);

/// --budget, s.
double budget_of(const Arguments&);

/// work_precision, with --verbose each run printed as it ends; runs that Ctrl-C cut short count as not begun. Null if it was
/// interrupted before there was a reference.
std::unique_ptr<WorkPrecision> measure(SceneBenchmark&, const Arguments&, const Interrupt&);

/// The run settings of a scene with the method and the setting of this run.
RunSettings settings_of(const RunSettings&, const WorkPrecisionRun&, const Registry&);

}  // namespace lockstep
