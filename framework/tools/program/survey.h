// What `chart` and `advise` measure of a scene: its trajectory, and the combinations that the registry and the words
// allow.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/tools/analysis/work_precision.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/progress.h"

namespace lockstep {

struct SceneSurvey {
  std::string title;
  Trajectory trajectory;
  WorkPrecisionOptions options;
  WorkPrecisionRun base;               ///< the scene's own way
  bool imposed = false;                ///< laws give the whole motion: nothing is left to integrate
  std::vector<std::string> remarks{};  ///< what was left out from the beginning, and why
};

/// The scene's own integrator, form, stabilisation and solver come first and are the base; what --integrators,
/// --formulations, --stabilisations and --solvers name is charted instead of everything. `loaded` and `interrupt` must
/// outlive it. Throws UsageError for words that cannot be, SceneError for a scene without an end.
SceneSurvey survey_of(const Loaded& loaded, const Words&, const Interrupt& interrupt);

/// Adaptive methods of the registry, with those keys of the settings' own integrator that they know before other
/// choices of keys; those first that are implicit or explicit as wanted, then the higher order. `registry` must outlive
/// them.
std::vector<MethodChoice> references_of(const RunSettings&, const Registry& registry, bool implicit);

/// Seconds that --budget says.
double budget_of(const Words&);

/// work_precision with each run printed as it comes; runs that Ctrl-C cut short count as not begun. Nothing when it
/// came before the reference was there.
std::unique_ptr<WorkPrecision> measure(SceneSurvey&, const Words&, const Interrupt&);

/// "  dop853   omega   project   sparse   tolerance 1e-06   ..." and the line above such lines.
std::string run_line(const WorkPrecisionRun&);
std::string run_heading();
/// "<= 0.0021 s".
std::string cost_text(double seconds, bool upper_bound);

/// A scene's run settings with this run's way in their place.
RunSettings settings_of(const RunSettings&, const WorkPrecisionRun&, const Registry&);

}  // namespace lockstep
