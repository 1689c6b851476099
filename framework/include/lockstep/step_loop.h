// The step loop, its events and observers.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/integrator.h>
#include <lockstep/lock.h>

namespace lockstep {

// Observer: is called with the accepted states of a run; never changes them.


/// Views, valid during the call. `values` is evaluated only when asked for: accelerations and multipliers at this very
/// state.
class Sample {
 public:
  Sample(Dynamics& dynamics, const State& s, const StepReport& r) : state(s), report(r), dynamics_(dynamics) {}
  const State& state;
  const StepReport& report;
  const System& system() const { return dynamics_.system(); }
  /// a, lambda, rows and inputs at this state; solved at the first call.
  const Solution& values() const {
    if (!values_) values_ = &dynamics_.evaluate(state);
    return *values_;
  }
  /// What a link does to the body of one of its markers, as Reactions::on_body_of; computed once for all channels that
  /// ask one after the other.
  const LinkWrench& wrench(const Lock& link, const Marker& at, int part = Reactions::kJoint) const {
    const Evaluated& v = values();
    if (last_.link != &link || last_.at != &at || last_.part != part)
      last_ = {&link, &at, part, Reactions(v).on_body_of(MarkerFrame(at), link, v.in, part)};
    return last_.wrench;
  }
  Dynamics& dynamics() const { return dynamics_; }

 private:
  struct Asked {
    const Lock* link = nullptr;
    const Marker* at = nullptr;
    int part = 0;
    LinkWrench wrench;
  };
  Dynamics& dynamics_;
  mutable const Solution* values_ = nullptr;
  mutable Asked last_;
};

/// Is shown accepted states; never changes them.
class LOCKSTEP_API Observer {
 public:
  virtual ~Observer();
  virtual void start(const Sample&);
  /// Every accepted step, with the state at its end.
  virtual void step(const Sample&);
  /// The velocities jumped at the end of the last step (an impact, a link switched, the jump of a law): the same
  /// instant, the state from which the run goes on.
  virtual void jumped(const Sample&);
  /// Every output time (the times asked for, or every step when none were): the state interpolated by the method's
  /// dense output and projected, or the end of a step.
  virtual void output(const Sample&);
  virtual void finish(const Sample&);
};


// Event: changes the set of links in force between two steps, by time or by a condition located to tolerance.


/// An instant at which the set of links or the state changes.
struct Event {
  enum class Crossing { any, rising, falling };
  std::string name;
  /// By time: at >= 0 and no condition. By condition: value(sample) passes zero in the given sense.
  double at = -1;
  std::function<double(const Sample&)> value{};
  Crossing crossing = Crossing::any;
  double tolerance = 1e-9;                            ///< of the instant, s
  bool once = true;                                   ///< or at every crossing
  std::vector<std::string> activate{}, deactivate{};  ///< links
  bool stop = false;                                  ///< end the run there
  std::function<void(State&)> change{};               ///< anything else; velocities are made consistent afterwards
};


// StepLoop: runs a mechanism. Makes steps, ends them on jumps, events and output times, accepts them, calls observers.


/// Steps, tolerances and outputs of a run.
struct StepLoopOptions {
  double step = 0;                     ///< fixed step, s; for adaptive methods the largest step (0: no limit)
  Tolerance tolerance{};               ///< adaptive methods
  double output = 0;                   ///< interval of output times from the start, s, and the end; 0: every step
  std::vector<double> output_times{};  ///< or these instants, rising (they win over `output`)
  double start_limit = 1e-6;  ///< a start that violates the constraints by more (m, m/s) is refused: assemble it first
};

/// Counters, warnings and the end of a run.
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

/// Runs a mechanism: steps, events, outputs, observers.
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
