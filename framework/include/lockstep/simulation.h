// Simulation: the short way to a run. Integrator and solver by name, a table of what is recorded.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/recorder.h>
#include <lockstep/registry.h>
#include <lockstep/step_loop.h>

namespace lockstep {

/// Methods by name, tolerances and outputs of a simulation.
struct SimulationOptions {
  std::string integrator = "dopri5";  ///< a name of the registry, with keys where wanted: "dop853:stages=auto"
  std::string solver = "schur";       ///< likewise
  double tolerance = 1e-8;            ///< relative error of a step, for integrators that control it
  double absolute_tolerance = 0;      ///< m, m/s, rad, rad/s; 0: a hundredth of `tolerance`
  double step = 0;  ///< s; integrators of fixed step need one, for the others it is the largest step (0: no limit)
  double output = 0;            ///< interval between rows of the table, s; 0: a row at every step
  DynamicsOptions dynamics{};   ///< formulation and stabilisation
  bool assemble = true;         ///< bring the start onto the constraints; otherwise a start that violates them is refused
};

/// A run of one system. What it is made of stays within reach: recorder(), loop(), dynamics().
///
///   Simulation run(system, {.integrator = "dopri5", .tolerance = 1e-8, .output = 0.01});
///   auto& table = run.record({"rod.angle_z", "energy.total"});
///   run.run_until(2.0);
class LOCKSTEP_API Simulation {
 public:
  /// The system must outlive the simulation. The registry is only read here. Throws ModelError or SceneError for an
  /// unknown name or key, a tolerance that is not positive, or a fixed step that is not given.
  explicit Simulation(System& system, SimulationOptions options = {}, const Registry& registry = builtin_registry());
  ~Simulation();

  /// Columns to record beside the time: channels, or pairs of a name and a channel. May be called several times before
  /// the run begins; afterwards it throws ModelError. The table grows during the run.
  const Table& record(std::vector<Request> requests);
  const Table& table() const { return recorder_.table(); }

  /// Runs on to time `t`, s; may be called again. Throws what StepLoop::run_until throws; what was recorded is kept.
  const SimulationReport& run_until(double t);

  const State& state();                              ///< at the present time; the assembled start before the run
  void set_state(State);                             ///< another start; it is assembled when the options say so
  const AssemblyReport& assembly();                  ///< what assembling the start changed
  Event& add_event(Event event);                     ///< as StepLoop::add_event
  void add_observer(Observer& observer);             ///< not owned
  Recorder& recorder() { return recorder_; }
  StepLoop& loop();                                  ///< begins the run: no channel can be added afterwards
  Dynamics& dynamics();                              ///< likewise

 private:
  void begin();
  void start_from(State start);

  System& system_;
  SimulationOptions options_;
  Tolerance tolerance_;
  Recorder recorder_;
  std::unique_ptr<Integrator> integrator_;  // until the loop takes them
  std::unique_ptr<LinearSolver> solver_;
  std::unique_ptr<Dynamics> dynamics_;
  std::unique_ptr<StepLoop> loop_;
  AssemblyReport assembly_;
};

}  // namespace lockstep
