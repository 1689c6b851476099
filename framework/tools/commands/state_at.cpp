// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/state_at.h"

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/program/method_specs.h"
#include "framework/tools/rank/cause.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {

State run_to(Mechanism& m, const Registry& registry, double t) {
  record_places(m);
  const std::unique_ptr<Recorder> recorder = make_recorder(m);
  std::vector<Event> events = make_events(m, *recorder);
  Dynamics dynamics = make_dynamics(m, registry);
  State start = assembled_start(dynamics, m);
  if (t == 0) {
    dynamics.to_slots(start);
    return start;
  }
  StepLoopOptions options = loop_options(m.run);
  options.output = t, options.output_times.clear();
  StepLoop loop(dynamics, make_integrator(m.run, registry), options);
  loop.add_observer(*recorder);
  for (Event& event : events) loop.add_event(std::move(event));
  const State started = start;
  loop.set_state(std::move(start));
  try {
    loop.run_until(t);
  } catch (const Error& error) {
    rethrow_of_run(system_of(m), loop, started, m.run.step, error);
  }
  const SimulationReport& report = loop.report();
  if (report.stopped)
    throw ModelError("the run ended at t = " + text::brief(loop.state().t) + " s, by '" + report.stopped_by +
                     "'; give a time --at before it");
  State state = loop.state();
  dynamics.to_slots(state);
  return state;
}

double instant_of(const Arguments& args) { return args["--at"].empty() ? 0 : instant("--at", args["--at"]); }

MechanismAt state_at(std::unique_ptr<Mechanism> mechanism, const Registry& registry, double t) {
  State state = run_to(*mechanism, registry, t);
  return mechanism_at(std::move(mechanism), registry, std::move(state));
}

std::string word_of(RowKind kind) {
  return kind == RowKind::translation ? "translation" : kind == RowKind::rotation ? "rotation" : "function";
}

}  // namespace lockstep
