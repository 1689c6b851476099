// StepLoop: runs a mechanism. Makes steps, ends them on jumps, events and output times, accepts them, calls observers.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "framework/dynamics/simulate/event.h"

namespace lockstep {

struct StepLoopOptions {
  double step = 0;                     ///< fixed step, s; for adaptive methods the largest step (0: no limit)
  Tolerance tolerance{};               ///< adaptive methods
  double output = 0;                   ///< interval of output times from the start, s, and the end; 0: every step
  std::vector<double> output_times{};  ///< or these instants, rising (they win over `output`)
  double start_limit = 1e-6;  ///< a start that violates the constraints by more (m, m/s) is refused: assemble it first
};

struct SimulationReport {
  long steps = 0, rejected = 0;
  double largest_violation = 0;                                  ///< |C| after accepted steps, m
  long impacts = 0;                                              ///< instants at which unilateral links were hit
  long manifold_steps = 0;                                       ///< steps with their stages on the constraints
  double stiff_since = std::numeric_limits<double>::infinity();  ///< first step that only damped fast modes limit, s
  bool stopped = false;                                          ///< by an event or by stop()
  std::string stopped_by;
  std::vector<std::string> warnings{};  ///< in the order in which they came
};

class LOCKSTEP_API StepLoop {
 public:
  StepLoop(Dynamics& dynamics, std::unique_ptr<Integrator> method, StepLoopOptions options = {});
  ~StepLoop();

  /// Where to start (a new run: observers are started again, the report is cleared); default: the system's start.
  /// Throws AssemblyError when it violates the constraints too much.
  void set_state(State);
  const State& state() const { return state_; }
  Dynamics& dynamics() { return dynamics_; }
  const System& system() const { return dynamics_.system(); }
  Integrator& integrator() { return *method_; }

  void add_observer(Observer&);  ///< not owned
  /// Throws ModelError for an event without instant and condition, or with an unknown link. An instant that lies before
  /// the start never comes. What fires at the end of a step is observed before it acts: samples show the state just
  /// before.
  Event& add_event(Event);
  /// Called after every accepted step with the time; return false to end the run after this step.
  std::function<bool(const State&)> progress{};

  /// Runs on to time `t`; may be called again for more. Observers: start once, finish at the end of every call. On an
  /// error what was observed so far is finished first (observers' finish is called), then it is thrown.
  const SimulationReport& run_until(double t);
  /// One accepted step of at most h (0: the method's or the option's own).
  StepReport step(double h = 0);
  const SimulationReport& report() const { return report_; }
  /// Puts a warning into the report and says it by the logger (support/log.h).
  void warn(const std::string& text);

 private:
  struct Parts;
  /// First call of a run: start checked, method begun, observers started, events of this very instant.
  void start();
  /// One accepted step, not past `limit`, and all that depends on it.
  void advance(double limit, double largest);
  void begin_method();
  void cross_jump(double t);
  bool fire_events();
  void apply(const Event&);
  void settle_contacts();
  void make_consistent(const std::string& cause);
  void observe_end();
  void output_inside();
  void output(const Sample&);
  void output_end();
  enum class Errors { thrown, dropped };
  void finish(Errors of_observers);

  Dynamics& dynamics_;
  std::unique_ptr<Integrator> method_;
  StepLoopOptions options_;
  State state_;
  std::vector<Observer*> observers_;
  SimulationReport report_;
  std::unique_ptr<Parts> parts_;
  bool begun_ = false;
};

}  // namespace lockstep
