// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/simulation.h>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/dynamics/simulate/step_loop_parts.h"
#include "framework/mechanism/params/read.h"
#include "framework/tools/simulation/checkpoint.h"
#include "framework/tools/simulation/simulation_parts.h"

namespace lockstep {

namespace {

// The options of a system's run as the settings that a scene gives. The default solver needs six velocities per body; one
// that is named means the formulation omega.
RunSettings settings_of(const SimulationOptions& options, const Registry& registry) {
  RunSettings run;
  run.tolerance = tolerance_of(options.tolerance);
  if (options.absolute_tolerance != 0) run.tolerance.atol_x = options.absolute_tolerance;
  check_tolerance(run.tolerance);
  run.integrator = read_method_spec(options.integrator, types_of(registry.integrators), "integrator");
  run.formulation = options.dynamics.formulation, run.stabilization = options.dynamics.stabilization;
  const bool quaternion = run.formulation == Formulation::quaternion;
  run.solver = read_method_spec(!options.solver.empty() ? options.solver
                                : quaternion            ? "sparse"
                                                        : "schur",
                                types_of(registry.solvers), "solver");
  if (!options.solver.empty() && run.formulation == Formulation::automatic) run.formulation = Formulation::omega;
  run.step = options.step, run.output = options.output, run.max_steps = options.max_steps;
  run.assemble = options.assemble;
  return run;
}

struct SystemSettings {
  RunSettings settings;
  Registry methods;  // integrators and solvers alone
};

/// The run of a system.
struct SystemParts final : SystemSettings, Simulation::Parts {
  SystemParts(System& of, const SimulationOptions& options, const Registry& registry)
      : SystemSettings{settings_of(options, registry), {}},
        Parts(of, SystemSettings::settings, std::make_unique<Recorder>(of)) {
    methods.integrators = registry.integrators, methods.solvers = registry.solvers;
    make_method(), make_solver();  // their errors are reported at once
  }
  std::unique_ptr<Integrator> make_method() const override {
    const MethodSpec& method = Parts::settings.integrator;
    std::unique_ptr<Integrator> made = make_integrator(method, methods, "simulation.integrator");
    if (!made->info().adaptive && !(Parts::settings.step > 0))
      throw ModelError(
          "simulation: integrator \"" + method.type + "\" uses fixed steps, and " +
          (Parts::settings.step == 0 ? "none is given" : "the step is " + text::number(Parts::settings.step)) +
          "; set .step, such as .step = 1e-3");
    return made;
  }
  std::unique_ptr<LinearSolver> make_solver() const override {
    return lockstep::make_solver(Parts::settings.solver, methods, "simulation.solver");
  }
};

void assemble_start(const RunSettings& settings, Dynamics& by, State& start, AssemblyReport& report) {
  if (settings.assemble)
    report = assemble(by, start);
  else
    begin_turns(by, start);
}

std::string name_of(const MethodSpec& method) {
  std::string name = method.type;
  if (method.keys.object() != nullptr)
    for (const Value::Member& m : *method.keys.object()) name += ":" + m.key + "=" + shown(m.value);
  return name;
}

// What a checkpoint of another simulation would differ in, in addition to what the loop compares.
std::string fingerprint(const RunSettings& run) {
  return fmt::format("integrator {}; solver {}; tolerance {} {}; step {} s; output {} s", name_of(run.integrator),
                     name_of(run.solver), run.tolerance.relative, run.tolerance.atol_x, run.step, run.output);
}
}  // namespace

Simulation::Parts::~Parts() = default;

StepLoop& Simulation::Parts::begun() {
  if (loop) return *loop;
  if (settings.solver.type != solver && settings.formulation == Formulation::automatic)
    settings.formulation = Formulation::omega;  // joint coordinates have no use for a solver that is named
  before();
  std::unique_ptr<Integrator> method = make_method();
  auto evaluates = std::make_unique<Dynamics>(system, make_solver(),
                                              DynamicsOptions{settings.formulation, settings.stabilization});
  auto runs = std::make_unique<StepLoop>(*evaluates, std::move(method), loop_options(settings));
  runs->add_observer(*recorder);
  started = begin(*evaluates, *runs, assembly);
  runs->set_state(started);
  dynamics = std::move(evaluates), loop = std::move(runs);
  system.begin_run(loop);
  return *loop;
}

/// Channels may add quadratures to the system, so everything that takes its sizes is made when the run begins.
State Simulation::Parts::begin(Dynamics& by, StepLoop&, AssemblyReport& report) {
  State start = system.start();
  assemble_start(settings, by, start, report);
  return start;
}

void Simulation::Parts::start_from(State start) {
  begun();
  assemble_start(settings, *dynamics, start, assembly);
  started = start;
  loop->set_state(std::move(start));
}

RunVerdict Simulation::Parts::verdict() const {
  throw ModelError("simulation: a run of a system has no verdict; add an EnergyAudit as an observer");
}

Simulation::Simulation(System& system, SimulationOptions options, const Registry& registry)
    : parts_(std::make_unique<SystemParts>(system, options, registry)) {}
Simulation::Simulation(System& system, SimulationOptions options)
    : Simulation(system, std::move(options), builtin_registry()) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

RunSettings& Simulation::settings() {
  if (parts_->loop) throw ModelError("simulation: settings() after the start of the run; change them before");
  return parts_->settings;
}
System& Simulation::system() { return parts_->system; }
const System& Simulation::system() const { return parts_->system; }

const Table& Simulation::record(std::vector<Request> requests) {
  if (parts_->loop) throw ModelError("simulation: record() after the start of the run; call it directly after the Simulation is made");
  for (Request& request : requests) {
    parts_->recorder->add(parts_->system, request);
    parts_->settings.record.push_back({std::move(request.channel), std::move(request.name), {}});
  }
  return table();
}
const Table& Simulation::record(const std::string& name, std::function<double(const Sample&)> value,
                                const std::string& unit) {
  record({});  // rejects a run that has begun
  parts_->recorder->add(name, unit, std::move(value));
  return table();
}
const Table& Simulation::table() const { return parts_->recorder->table(); }

const SimulationReport& Simulation::run_until(double t) {
  return parts_->attempt([&]() -> const SimulationReport& { return loop().run_until(t); });
}
const SimulationReport& Simulation::run() {
  if (!(parts_->settings.until >= 0))
    throw ModelError(
        "simulation: run() needs an end; set settings().until (\"until\" of \"run\" in a scene), or call run_until(t)");
  return run_until(parts_->settings.until);
}
RunVerdict Simulation::verdict() const { return parts_->verdict(); }

const State& Simulation::state() { return loop().state(); }
void Simulation::set_state(State state) { parts_->start_from(std::move(state)); }
const AssemblyReport& Simulation::assembly() {
  parts_->begun();
  return parts_->assembly;
}
Event& Simulation::add_event(Event event) { return loop().add_event(std::move(event)); }
void Simulation::add_observer(Observer& observer) { loop().add_observer(observer); }
const SimulationReport& Simulation::advance(double h) {
  return parts_->attempt([&]() -> const SimulationReport& { return loop().advance(h); });
}
void Simulation::activate(const std::string& name) { loop().activate(name); }
void Simulation::deactivate(const std::string& name) { loop().deactivate(name); }
ControlInput& Simulation::input(const std::string& name) { return parts_->system.input(name); }
void Simulation::on_row(std::function<void(std::span<const double>)> tell, bool keep) {
  parts_->recorder->on_row(std::move(tell), keep);
}
Recorder& Simulation::recorder() { return *parts_->recorder; }
StepLoop& Simulation::loop() { return parts_->begun(); }
Dynamics& Simulation::dynamics() {
  parts_->begun();
  return *parts_->dynamics;
}

void Simulation::save(const std::string& file) {
  Snapshot out;
  out.put_text("simulation"), out.put_text(fingerprint(parts_->settings));
  loop().save(out);
  write_checkpoint(file, out);
}

void Simulation::load(const std::string& file) {
  const Snapshot saved = read_checkpoint(file);
  SnapshotReader in(saved);
  if (const std::string kind = in.get_text(); kind != "simulation")
    throw ModelError(fmt::format("checkpoint '{}' belongs to the program; continue it by `lockstep resume`", file));
  if (const std::string other = in.get_text(), own = fingerprint(parts_->settings); other != own)
    throw ModelError(fmt::format("checkpoint '{}' belongs to a simulation with other options: {}", file,
                                 first_difference(other, own)));
  loop().load(in);
  parts_->started = loop().state();
}

}  // namespace lockstep
