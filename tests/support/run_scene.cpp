// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/run_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/author/registry.h>
#include <lockstep/sweep.h>
#include "tests/support/paths.h"
#include "tests/support/run_with_registry.h"

namespace lockstep {

std::string scene_path(const std::string& name) { return std::string(paths::kScenes) + "/" + name + ".json"; }

Table trusted(const std::string& csv) {
  return read_csv(std::string(paths::kSource) + "/tests/verification/data/" + csv + ".csv");
}

SceneRun run_scene(const std::string& path, const std::function<void(RunSettings&)>& change,
                   const std::function<void(Scene&)>& describe) {
  return run_with_registry(builtin_registry(), path, change, describe);
}

SceneRun run_with_registry(const Registry& registry, const std::string& path,
                           const std::function<void(RunSettings&)>& change,
                           const std::function<void(Scene&)>& describe) {
  Scene scene = read_scene(path);
  if (change) change(scene.run);
  if (describe) describe(scene);
  Mechanism mechanism = build_mechanism(scene, registry);
  const RunSettings& run = mechanism.run;
  const std::unique_ptr<Recorder> recorder = make_recorder(mechanism);
  std::vector<Event> events = make_events(mechanism, *recorder);
  Dynamics dynamics(system_of(mechanism), make_solver(run, registry), {run.formulation, run.stabilization});
  SceneRun result;
  State start = mechanism.system.start();
  if (run.assemble) result.assembly = assemble(dynamics, start, mechanism.start_speeds, mechanism.assembly);
  StepLoop simulation(
      dynamics, make_integrator(run, registry),
      {.step = run.step, .tolerance = run.tolerance, .output = run.output, .output_times = run.times});
  simulation.set_state(start);
  simulation.add_observer(*recorder);
  for (Event& event : events) simulation.add_event(std::move(event));
  result.report = simulation.run_until(std::max(run.until, 0.0));
  result.work = dynamics.work();
  result.n_velocities = mechanism.system.n_velocities();
  result.table = recorder->table();
  return result;
}

std::vector<ColumnError> compare(const Table& ours, const Table& trusted) {
  if (!ours.has("t")) return {};
  std::vector<ColumnError> errors;
  const std::size_t n = trusted.n_rows();
  std::vector<double> sign(n, 1.0);  // of the quaternion, row by row
  if (ours.has("qw") && trusted.has("qw"))
    for (std::size_t i = 0; i < std::min(n, ours.n_rows()); ++i) {
      double dot = 0;
      for (const char* c : {"qw", "qx", "qy", "qz"}) dot += ours[c][i] * trusted[c][i];
      if (dot < 0) sign[i] = -1.0;
    }
  for (const auto& column : trusted.columns()) {
    if (!ours.has(column.name)) continue;
    const std::vector<double>&a = ours[column.name], &b = column.values;
    ColumnError e{column.name};
    if (a.size() != b.size()) e.error = std::numeric_limits<double>::infinity();
    const bool quaternion = column.name.size() == 2 && column.name[0] == 'q' &&
                            std::string("wxyz").find(column.name[1]) != std::string::npos;
    for (double x : b) e.size = std::max(e.size, std::abs(x));
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      const double d = std::abs((quaternion ? sign[i] : 1.0) * a[i] - b[i]);
      if (!(d <= e.error)) e.error = d;  // a NaN stays
    }
    errors.push_back(e);
  }
  return errors;
}

}  // namespace lockstep
