// SPDX-License-Identifier: BSD-3-Clause

#include <spdlog/spdlog.h>

#include <lockstep/author/registry.h>
#include <lockstep/log.h>
#include <lockstep/scene.h>
#include <lockstep/sweep.h>
#include "framework/tools/scene_run/scene_run.h"
#include "tests/fuzz/answered.h"
#include "tests/fuzz/targets.h"

namespace lockstep::fuzz {

namespace {

// What runs in a second with checks: the sizes of a mechanism, and the steps of each integrator.
constexpr std::size_t kManyBodies = 10, kManyLinks = 16;
constexpr long kManySteps = 100;
constexpr double kUntil = 0.1;

const Registry& builtins() {
  static const Registry registry = [] {
    logger()->set_level(spdlog::level::off);
    return builtin_registry();
  }();
  return registry;
}

bool is_small(const Mechanism& m) {
  return m.system.bodies().size() <= kManyBodies && m.system.links().size() + m.system.forces().size() <= kManyLinks &&
         m.run.record.size() <= 40;
}

void check_finite(const Table& table) {
  for (const Column& column : table.columns())
    for (const double x : column.values) must_be_finite(x, "column " + column.name);
}

void run_with(Scene& scene, const std::string& integrator) {
  // One of each kind of solver and formulation as the scene says; its method, step and outputs are ours.
  scene.run.integrator = {integrator};
  scene.run.step = 0.005, scene.run.until = kUntil, scene.run.output = 0.02, scene.run.times.clear();
  scene.run.max_steps = kManySteps, scene.run.tolerance = {1e-4, 1e-6};
  Table table;
  answered([&] {
    Mechanism mechanism = build_mechanism(scene, builtins());
    if (!is_small(mechanism)) return;
    const std::unique_ptr<Recorder> recorder = make_recorder(mechanism);
    std::vector<Event> events = make_events(mechanism, *recorder);
    const RunSettings& run = mechanism.run;
    Dynamics dynamics(system_of(mechanism), make_solver(run, builtins()), {run.formulation, run.stabilization});
    State start = mechanism.system.start();
    if (run.assemble) assemble(dynamics, start, mechanism.start_speeds);
    StepLoop loop(dynamics, make_integrator(run, builtins()),
                  {.step = run.step, .tolerance = run.tolerance, .output = run.output, .max_steps = run.max_steps});
    loop.set_state(start);
    loop.add_observer(*recorder);
    for (Event& event : events) loop.add_event(std::move(event));
    try {
      loop.run_until(run.until);
    } catch (...) {
      table = recorder->table();  // what was computed is as good as without the error
      throw;
    }
    table = recorder->table();
  });
  check_finite(table);
}

}  // namespace

void scene(Bytes bytes) {
  answered([&] {
    const Scene read = scene_from_text(text_of(bytes), "fuzz.json");
    const Mechanism mechanism = build_mechanism(read, builtins());
    mechanism.system.start();
  });
}

void run(Bytes bytes) {
  Scene read;
  answered([&] {
    const Scene given = scene_from_text(text_of(bytes), "fuzz.json");
    if (is_small(build_mechanism(given, builtins())))
      read = given;  // one that is rejected would be so with all methods
  });
  if (read.root.is_null()) return;
  for (const auto& [name, entry] : builtins().integrators.entries()) run_with(read, name);
  if (read.run.formulation == Formulation::joint) return;
  read.run.formulation = Formulation::joint;
  for (const char* name : {"dopri5", "rk4", "dop853"}) run_with(read, name);
}

}  // namespace lockstep::fuzz
