// SPDX-License-Identifier: BSD-3-Clause
// Names, labels and the CSV of work-precision results.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/foundation/support/csv_cells.h"
#include "framework/tools/precision/work_precision_chart.h"

namespace lockstep {

std::string to_string(Stabilization::Kind kind) {
  if (kind == Stabilization::Kind::baumgarte) return "baumgarte";
  return kind == Stabilization::Kind::none ? "none" : "project";
}

std::string to_string(ErrorKind kind) {
  constexpr const char* kNames[] = {"position", "velocity", "energy", "reaction"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* unit_of(ErrorKind kind) {
  constexpr const char* kUnits[] = {"m", "m/s", "J", "N"};
  return kUnits[static_cast<std::size_t>(kind)];
}

std::string to_string(ChartBy by) {
  constexpr const char* kNames[] = {"integrator", "formulation", "stabilization", "solver"};
  return kNames[static_cast<std::size_t>(by)];
}

std::string way_of(const WorkPrecisionRun& run) {
  return fmt::format("{}, {}, {}{}", run.integrator, to_string(run.used), to_string(run.stabilization),
                     needs_no_solver(run.used) ? "" : ", " + run.solver);
}

std::string label(const WorkPrecisionRun& run) {
  return way_of(run) +
         (run.adaptive ? fmt::format(", tolerance {:.3g}", run.setting) : fmt::format(", step {:.3g} s", run.setting));
}

std::string runs_text(const WorkPrecision& result) {
  std::string text =
      "integrator,formulation,stabilization,solver,tolerance,step [s],position error [m],velocity error [m/s],energy "
      "error [J],reaction error [N],cpu [s],evaluations,factors,steps,rejected,counts,front,failure\n";
  const std::vector<const WorkPrecisionRun*> front = pareto_front(result);
  for (const WorkPrecisionRun& r : result.runs) {
    const std::string setting = r.adaptive ? fmt::format("{},", r.setting) : fmt::format(",{}", r.setting);
    const std::string errors = r.done() ? fmt::format("{:.6g},{:.6g},{:.6g},{:.6g}", r.error.position, r.error.velocity,
                                                      r.error.energy, r.error.reaction)
                                        : ",,,";
    const bool on_front = std::find(front.begin(), front.end(), &r) != front.end();
    text +=
        fmt::format("{},{},{},{},{},{},{:.6g},{},{},{},{},{},{},{}\n", r.integrator, to_string(r.formulation),
                    to_string(r.stabilization), r.solver, setting, errors, r.cpu, r.evaluations, r.factors, r.steps,
                    r.rejected, counts(result, r) ? 1 : 0, on_front ? 1 : 0, csv_cell(r.wrong ? "wrong" : r.failure));
  }
  return text;
}

}  // namespace lockstep
