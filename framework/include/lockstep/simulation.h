// SPDX-License-Identifier: BSD-3-Clause
// Simulation: a run of a system or of a scene, with integrator and solver by name and a table of recorded channels.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lockstep/dynamics_options.h>
#include <lockstep/table.h>

namespace lockstep {

class ControlInput;
class Dynamics;
class Observer;
class Recorder;
class Registry;
class Sample;
class StepLoop;
class System;
struct AssemblyReport;
struct Event;
struct Mechanism;
struct RunSettings;
struct RunVerdict;
struct SimulationReport;
struct State;

/// Methods by name, tolerances and outputs of a simulation.
struct SimulationOptions {
  std::string integrator = "dopri5";  ///< a name of the registry, with optional keys: "dop853:stages=auto"
  /// The same for the linear solver. A named solver means the formulation omega, unless `dynamics` gives another.
  /// Empty: as in a scene without it, schur (with the formulation quaternion sparse), or joint coordinates.
  std::string solver{};
  double tolerance = 1e-8;        ///< relative error of a step, for integrators that control it
  double absolute_tolerance = 0;  ///< m, m/s, rad, rad/s; 0: a hundredth of `tolerance`
  double step = 0;    ///< s; integrators with fixed steps need one, for the others it is the largest step (0: no limit)
  double output = 0;  ///< interval between rows of the table, s; 0: a row at every step
  long max_steps = 0;          ///< the run ends with a StepError after this number of steps; 0: no limit
  DynamicsOptions dynamics{};  ///< formulation and stabilisation
  bool assemble = true;        ///< the start is assembled; otherwise a start that violates the constraints is an error
};

/// A run of a scene, or of one system. Its parts stay accessible: recorder(), loop(), dynamics().
///
///     Simulation run(read_mechanism("four_bar.json", {{"crank", "0.12 m"}}));
///     run.run();
///     write_csv("four_bar.csv", run.table());
///
///     Simulation run(system, {.integrator = "dopri5", .tolerance = 1e-8, .output = 0.01});
///     auto& table = run.record({"rod.angle_z", "energy.total"});
///     run.run_until(2.0);
///
/// It may be moved, also during a run; its parts stay at their place in memory.
class LOCKSTEP_API Simulation {
 public:
  /// The system must outlive the simulation; the registry is read only here. Throws ModelError or SceneError for an
  /// unknown name or key, a tolerance that is not positive, or a fixed step that is not given.
  Simulation(System& system, SimulationOptions options, const Registry& registry);
  /// The same by the built-in registry.
  explicit Simulation(System& system, SimulationOptions options = {});
  /// Runs a scene as the program does: its start, events, tolerance, step, formulation, outputs and columns. Energy, drift,
  /// tolerance and singular configurations are watched: verdict(). In liblockstep-run. Throws SceneError with the
  /// place in the file of a channel that does not exist.
  explicit Simulation(Mechanism mechanism);
  Simulation(Simulation&&) noexcept;             ///< the run continues in the new one
  Simulation& operator=(Simulation&&) noexcept;  ///< the same; the earlier run ends
  ~Simulation();

  /// Integrator, tolerance, step, outputs and end; changes before the run begins take effect. Throws ModelError after
  /// it has begun. Columns are added by record(). A solver that is named here means the formulation omega, unless
  /// `formulation` gives another.
  RunSettings& settings();
  System& system();              ///< as given, or that of the scene; change it before the run begins
  const System& system() const;  ///< the same

  /// Adds columns to record in addition to the time: channels, or pairs of a name and a channel. Returns the table,
  /// which grows during the run. May be called several times. Throws ModelError for an unknown channel, a name that is
  /// taken, and after the run has begun.
  const Table& record(std::vector<Request> requests);
  /// Adds a column of a function: record("v", [&](const Sample& s) { return s.inputs().slot(rod.slot).v.norm(); }, "m/s").
  /// It reads the state at each row. Throws ModelError as the other, and for an empty function.
  const Table& record(const std::string& name, std::function<double(const Sample&)> value,
                      const std::string& unit = {});
  const Table& table() const;  ///< recorded so far

  /// Runs to the time t, s; may be called again. Throws what assemble() and StepLoop::run_until throw; recorded rows
  /// are kept.
  const SimulationReport& run_until(double t);
  /// Runs to settings().until, which a scene gives by "until" of "run". Throws ModelError if none is given, and
  /// what run_until() throws.
  const SimulationReport& run();
  /// The program's verdict on the run so far: energy, drift, and findings that make the result doubtful. Throws
  /// ModelError for a run of a system, which has observers only (EnergyAudit), and for a scene whose run has not begun.
  RunVerdict verdict() const;

  /// Writes the run to a checkpoint, a file that replaces an older one when it is complete. Table, events and the data
  /// of observers (Observer::save) are part of it. Throws ModelError if the run has not begun or cannot be saved
  /// (StepLoop::save), FileError.
  void save(const std::string& file);
  /// Continues from a checkpoint, in place of a start, with the same system, options, columns, events and observers:
  /// the run is then equal to the last bit to the one that was saved. Throws FileError if the file is not a checkpoint,
  /// is damaged or of another version, ModelError if it belongs to another simulation.
  void load(const std::string& file);

  /// As StepLoop::input; does not begin the run.
  ControlInput& input(const std::string& name);
  /// As Recorder::on_row.
  void on_row(std::function<void(std::span<const double>)> tell, bool keep = false);

  // -- after any of these no column can be added
  const State& state();                       ///< at the present time; before the run the assembled start
  void set_state(State);                      ///< sets another start, which is assembled if the options require it
  const AssemblyReport& assembly();           ///< changes of the start by assembly
  Event& add_event(Event event);              ///< as StepLoop::add_event
  void add_observer(Observer& observer);      ///< not owned
  const SimulationReport& advance(double h);  ///< as StepLoop::advance
  void activate(const std::string& name);     ///< as StepLoop::activate
  void deactivate(const std::string& name);   ///< as StepLoop::deactivate
  Recorder& recorder();                       ///< fills the table; reading it does not begin the run
  StepLoop& loop();                           ///< runs the mechanism
  Dynamics& dynamics();                       ///< by which the loop evaluates

  struct Parts;  ///< its parts

 private:
  std::unique_ptr<Parts> parts_;
};

}  // namespace lockstep
