// SPDX-License-Identifier: BSD-3-Clause
// A Simulation of a scene: what the program runs, as one object.
#include <algorithm>

#include "framework/tools/rank/cause.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/singular_watch.h"
#include "framework/tools/scene_run/requirements.h"
#include "framework/tools/scene_run/rows_at_jumps.h"
#include "framework/tools/scene_run/scene_run.h"
#include "framework/tools/simulation/simulation_parts.h"

namespace lockstep {

namespace {

struct HeldMechanism {
  Mechanism mechanism;
};

/// The run of a scene.
struct SceneParts final : HeldMechanism, Simulation::Parts {
  explicit SceneParts(Mechanism&& m)
      : HeldMechanism{std::move(m)},
        Parts(system_of(mechanism), mechanism.run, make_recorder(mechanism)),
        events(make_events(mechanism, *recorder)),
        at_jumps([this](const Sample& s) { recorder->output(s); }, *recorder),
        singular(system) {}

  std::unique_ptr<Integrator> make_method() const override { return make_integrator(settings, *mechanism.methods); }
  std::unique_ptr<LinearSolver> make_solver() const override {
    return lockstep::make_solver(settings, *mechanism.methods);
  }
  void before() override {
    requirements = make_requirements(mechanism);
    audit = std::make_unique<EnergyAudit>(system, settings.limits);
  }
  State begin(Dynamics& by, StepLoop& run, AssemblyReport& report) override {
    State start = assembled_start(by, mechanism, &report);
    if (settings.at_jumps) run.add_observer(at_jumps);
    if (requirements) run.add_observer(*requirements);
    run.add_observer(*audit);
    const bool adaptive = run.integrator().info().adaptive;
    doubts = std::make_unique<Doubts>(are_of_reactions(settings.record), adaptive ? settings.tolerance.relative : 0.0);
    run.add_observer(*doubts);
    if (SingularWatch::is_needed(by, start, run.integrator().info())) run.add_observer(singular);
    for (const Event& event : events) run.add_event(event);
    return start;
  }
  RunVerdict verdict() const override {
    if (!loop) throw ModelError("simulation: verdict() was called before the start of the run; call it after run()");
    RunVerdict found{audit->result(), run_findings(*loop, audit->result(), *doubts, singular)};
    for (Finding& f : broken_requirements(mechanism, requirements.get())) found.findings.push_back(std::move(f));
    for (Finding& f : share_findings(system, mechanism, {&started, &loop->state()}))
      found.findings.push_back(std::move(f));
    found.right =
        std::ranges::none_of(found.findings, [](const Finding& f) { return f.severity() == Severity::wrong; });
    return found;
  }

  void rethrow(const Error& error) override {
    if (loop) rethrow_of_run(system, *loop, started, settings.step, error);
  }

  std::vector<Event> events;
  RowsAtJumps at_jumps;
  SingularWatch singular;
  std::unique_ptr<Requirements> requirements;  // null: none
  std::unique_ptr<EnergyAudit> audit;
  std::unique_ptr<Doubts> doubts;
};

}  // namespace

Simulation::Simulation(Mechanism mechanism) : parts_(std::make_unique<SceneParts>(std::move(mechanism))) {}

}  // namespace lockstep
