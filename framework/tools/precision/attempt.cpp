// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/attempt.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include <lockstep/error.h>

namespace lockstep {
namespace {

std::vector<double> output_times(const Trajectory& trajectory, RunKind kind) {
  std::vector<double> times;
  if (kind == RunKind::plain) return {trajectory.length};
  for (int k = 0; k <= trajectory.outputs; ++k) times.push_back(trajectory.length * k / trajectory.outputs);
  return times;
}

// A ModelError or SceneError before the first step: the method cannot run this mechanism.
void note_failure(const Error& error, Outcome& out) {
  out.failure = error.what();
  const Error::Kind kind = error.kind();
  out.unsuited = (kind == Error::Kind::model || kind == Error::Kind::scene) && out.report.steps == 0;
}

}  // namespace

Outcome attempt_run(const Trajectory& trajectory, const Recipe& recipe, double limit, const Clocks& clocks,
                    RunKind kind) {
  Outcome out;
  const Subject subject = kind == RunKind::reference && trajectory.truth ? trajectory.truth() : trajectory.make();
  HistoryObserver observer(*subject.system, clocks.cpu, out.history);
  const double begin = clocks.cpu(), clock_begin = clocks.clock();
  try {
    Dynamics dynamics(*subject.system, recipe.solver->make(), recipe.dynamics);
    StepLoop sim(dynamics, recipe.method->make(),
                 {.step = recipe.step, .tolerance = recipe.tolerance, .output_times = output_times(trajectory, kind)});
    sim.set_state(subject.start);
    for (Observer* o : subject.observers) sim.add_observer(*o);
    if (kind != RunKind::plain) sim.add_observer(observer);
    const bool judged = kind == RunKind::observed && subject.audit != nullptr;
    if (judged) sim.add_observer(*subject.audit);
    for (const Event& event : subject.events) sim.add_event(event);
    sim.progress = [&](const State&) { return !(out.given_up = !(clocks.clock() - clock_begin <= limit)); };
    try {
      sim.run_until(trajectory.length);
    } catch (const Error& error) {
      out.report = sim.report();
      note_failure(error, out);
    }
    out.report = sim.report();
    out.work = dynamics.work();
    out.wrong = judged && subject.audit->result().is_wrong();
    State end = sim.state();
    out.used = recipe.dynamics.formulation != Formulation::automatic ? recipe.dynamics.formulation
               : end.coordinates != nullptr                          ? Formulation::joint
                                                                     : Formulation::omega;
    out.dense = out.failure.empty() && sim.integrator().dense(sim.state().t, end);
  } catch (const Error& error) {
    note_failure(error, out);
  }
  out.cpu = clocks.cpu() - begin - observer.cpu();
  out.work.evaluations -= observer.evaluations(), out.work.factors -= observer.evaluations();
  if (out.given_up && std::isinf(clocks.clock()))
    out.given_up = false, out.interrupted = true, out.failure = "interrupted";
  else if (out.given_up && out.failure.empty())
    out.failure = fmt::format("stopped after {:.2g} s of CPU time", out.cpu);
  else if (out.failure.empty() && out.report.stopped)
    out.failure = "stopped by '" + out.report.stopped_by + "' before the end";
  return out;
}

}  // namespace lockstep
