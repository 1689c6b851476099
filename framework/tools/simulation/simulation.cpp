#include <lockstep/simulation.h>

#include <spdlog/fmt/fmt.h>

#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/registry.h>
#include <lockstep/text.h>
#include "framework/dynamics/simulate/start_turns.h"
#include "framework/tools/record/start_of_angle.h"
#include "framework/tools/simulation/checkpoint.h"

namespace lockstep {

namespace {

// The solver that is taken: the default needs six velocities per body.
std::string solver_of(const SimulationOptions& options) {
  if (!options.solver.empty()) return options.solver;
  return options.dynamics.formulation == Formulation::quaternion ? "sparse" : "schur";
}

}  // namespace

Simulation::Simulation(System& system, SimulationOptions options, const Registry& registry)
    : system_(system), options_(std::move(options)), recorder_(system) {
  if (!(options_.tolerance > 0) || !(options_.absolute_tolerance >= 0))
    throw ModelError("simulation: tolerance " + text::brief(options_.tolerance) + ", absolute_tolerance " +
                     text::brief(options_.absolute_tolerance) + "; give a positive tolerance, such as 1e-8");
  tolerance_.relative = options_.tolerance;
  tolerance_.atol_x = options_.absolute_tolerance > 0 ? options_.absolute_tolerance : 0.01 * options_.tolerance;
  const MethodSpec method = read_method_spec(options_.integrator, types_of(registry.integrators));
  integrator_ = make_integrator(method, registry, "simulation.integrator");
  if (!integrator_->info().adaptive && !(options_.step > 0))
    throw ModelError("simulation: integrator \"" + method.type +
                     "\" takes fixed steps and no step is given; set .step, for instance .step = 1e-3");
  solver_ =
      make_solver(read_method_spec(solver_of(options_), types_of(registry.solvers)), registry, "simulation.solver");
}

Simulation::~Simulation() = default;

const Table& Simulation::record(std::vector<Request> requests) {
  if (loop_) throw ModelError("simulation: record() after the run began; ask for all columns before run_until()");
  for (Request& request : requests) {
    Channel channel = make_channel(system_, request.channel);
    recorded_.push_back(std::move(request.channel));
    channel.name = std::move(request.name);
    recorder_.add(std::move(channel));
  }
  return recorder_.table();
}

/// Channels may add quadratures to the system, so everything that takes its sizes is made when the run begins.
void Simulation::begin() {
  if (loop_) return;
  DynamicsOptions taken = options_.dynamics;
  if (!options_.solver.empty() && taken.formulation == Formulation::automatic) taken.formulation = Formulation::omega;
  dynamics_ = std::make_unique<Dynamics>(system_, std::move(solver_), taken);
  StepLoopOptions loop;
  loop.step = options_.step;
  loop.output = options_.output;
  loop.max_steps = options_.max_steps;
  loop.tolerance = tolerance_;
  loop_ = std::make_unique<StepLoop>(*dynamics_, std::move(integrator_), loop);
  loop_->add_observer(recorder_);
  if (const std::string words = channels::uncounted(system_, {}, recorded_); !words.empty()) log_warning(words);
  start_from(system_.start());
}

void Simulation::start_from(State start) {
  if (options_.assemble)
    assembly_ = assemble(*dynamics_, start);
  else
    begin_turns(*dynamics_, start);
  loop_->set_state(std::move(start));
}

const SimulationReport& Simulation::run_until(double t) { return loop().run_until(t); }
const State& Simulation::state() { return loop().state(); }
Event& Simulation::add_event(Event event) { return loop().add_event(std::move(event)); }
void Simulation::add_observer(Observer& observer) { loop().add_observer(observer); }

void Simulation::set_state(State state) {
  begin();
  start_from(std::move(state));
}

const AssemblyReport& Simulation::assembly() {
  begin();
  return assembly_;
}

StepLoop& Simulation::loop() {
  begin();
  return *loop_;
}

Dynamics& Simulation::dynamics() {
  begin();
  return *dynamics_;
}

// What a checkpoint of another simulation would differ in, beside what the loop compares itself.
std::string Simulation::fingerprint() const {
  return fmt::format("integrator {}, solver {}, tolerance {:a} {:a}, step {:a}, output {:a}", options_.integrator,
                     solver_of(options_), tolerance_.relative, tolerance_.atol_x, options_.step, options_.output);
}

void Simulation::save(const std::string& file) {
  Snapshot out;
  out.put_text("simulation"), out.put_text(fingerprint());
  loop().save(out);
  write_checkpoint(file, out);
}

void Simulation::load(const std::string& file) {
  const Snapshot in = read_checkpoint(file);
  if (const std::string kind = in.get_text(); kind != "simulation")
    throw ModelError(
        fmt::format("checkpoint '{}' is one of the program's (lockstep resume), not of a simulation", file));
  if (const std::string saved = in.get_text(), own = fingerprint(); saved != own)
    throw ModelError(
        fmt::format("checkpoint '{}' is of a simulation with other options ({}); this one has {}", file, saved, own));
  loop().load(in);
}

}  // namespace lockstep
