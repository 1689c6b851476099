// SPDX-License-Identifier: BSD-3-Clause
// The step loop, its events and observers.
#pragma once

#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/author/integrator.h>
#include <lockstep/author/lock.h>
#include <lockstep/finding.h>
#include <lockstep/system.h>

namespace lockstep {

struct Delivery;
struct Solution;

// Observer: is called with the accepted states of a run, and never changes them.

/// A state of a run as observers and channels see it. All are views, valid during the call; accelerations and
/// multipliers are solved for only when they are needed.
class LOCKSTEP_API Sample {
 public:
  /// Of the state `s`, which the step `r` led to. All three must outlive it. `known`: its inputs, as Dynamics read them last;
  /// null: they are read at the first call of inputs().
  Sample(Dynamics& dynamics, const State& s, const StepReport& r, const Inputs* known = nullptr);
  const State& state;        ///< the state
  const StepReport& report;  ///< of the last step
  /// Cause of the change for Observer::jumped: "event 'grab'", "a call", "an impact", "the jump of a law"; else "".
  std::string_view cause{};
  const System& system() const;  ///< the mechanism
  /// Accelerations, multipliers, rows and inputs at this state; solved at the first call. Throws what
  /// Dynamics::solution_at throws.
  const Solution& values() const;
  /// Accelerations alone: of values() if these are solved already, else by Dynamics::accelerations() at the first call.
  const VecX& accelerations() const;
  /// Motions of all slots, integrated states and memory at this state; read again only after those of another.
  const Inputs& inputs() const;
  /// Force and moment that a joint exerts on the body of one of its markers, by Reactions::on_body_of; computed once
  /// for consecutive channels.
  const LinkWrench& wrench(const Lock& link, const Marker& at, int part = Reactions::kJoint) const;
  /// Solves again at the next call of values() or accelerations(), after the dynamics was used for another state.
  void forget() const { values_ = nullptr, a_ = nullptr, last_ = {}; }
  Dynamics& dynamics() const { return dynamics_; }  ///< by which values() solves

 private:
  struct Asked {
    const Lock* link = nullptr;
    const Marker* at = nullptr;
    int part = 0;
    LinkWrench wrench;
  };
  Dynamics& dynamics_;
  mutable const Solution* values_ = nullptr;
  mutable const VecX* a_ = nullptr;
  mutable const Inputs* inputs_;
  mutable long read_;  // Dynamics::inputs_read() then
  mutable Asked last_;
};

/// The last step of a run, with the states inside it. A run is the same whether observers look at them or not.
class LOCKSTEP_API InsideStep {
 public:
  virtual ~InsideStep();
  virtual double begin() const = 0;       ///< time of its start, s
  virtual const Sample& end() const = 0;  ///< the state at its end
  virtual bool has_states() const = 0;    ///< whether the method has dense output
  /// The state at t, begin() < t < end().state.t, valid until the next call. Only if has_states(). Throws StepError if it
  /// cannot be projected.
  virtual Sample at(double t) const = 0;
  /// Whether laws alone move the mechanism: the error of the method then does not limit the step.
  virtual bool along_laws() const = 0;
};

/// Base of observers of a run: it is called with accepted states and never changes them. By default all calls do
/// nothing.
class LOCKSTEP_API Observer {
 public:
  virtual ~Observer();
  /// Called once at the start of a run.
  virtual void start(const Sample&) {}
  /// Called after every accepted step, before the outputs inside it and before step().
  virtual void inside(const InsideStep&) {}
  /// Called after every accepted step, with the state at its end.
  virtual void step(const Sample&) {}
  /// Called after step() with the state on which an event, an impact or the jump of a law then acts.
  virtual void before_jump(const Sample&) {}
  /// Called after step() if an event, an impact or the jump of a law acted at its end: at the same time, with the state
  /// from which the run continues.
  virtual void jumped(const Sample&) {}
  /// Called at every output time (the requested times, or every step if there are none): the state interpolated by the
  /// method's dense output and projected, or the end of a step.
  virtual void output(const Sample&) {}
  /// Called at the end of every StepLoop::run_until, also when it throws.
  virtual void finish(const Sample&) {}
  /// Writes the data that it keeps from call to call, for a checkpoint. Default: nothing.
  virtual void save(Snapshot&) const {}
  /// Restores what save() wrote, in the same order; start() was called before, at the state of the checkpoint.
  /// Default: nothing.
  virtual void load(SnapshotReader&) {}
  /// Whether save() writes all that it keeps from call to call; false: runs with it have no checkpoints. Default: true.
  virtual bool saves_all() const { return true; }
  /// Whether it keeps rows: a call of output(), jumped() or before_jump() that threw is then repeated
  /// when the run continues, so that no row is lost. Default: false, since an error may be meant to stop the run.
  virtual bool keeps_rows() const { return false; }
};

// Event: changes the active joints or the state between two steps, by time or by a condition located to tolerance.

/// A time at which joints are switched, the state changes or the run ends.
struct Event {
  /// Sense in which the condition passes zero.
  enum class Crossing {
    any,     ///< either
    rising,  ///< from below
    falling  ///< from above
  };
  std::string name;  ///< for messages and SimulationReport::stopped_by
  /// By time: this time, s, >= 0, and no condition. By condition: value(sample) passes zero in the given sense within a
  /// step. A double crossing inside a step is found if it lasts longer than a part of the step: a quarter, or a
  /// rotation of pi/8 of the fastest body if that is shorter; 1/256 if laws alone move the mechanism. A shorter one is
  /// found if the condition has one extremum in it. No output is beyond zero without an event, except after a start
  /// there. For methods without dense output crossings are sought along a cubic polynomial.
  double at = -1;
  std::function<double(const Sample&)> value{};  ///< the condition, or none
  Crossing crossing = Crossing::any;             ///< sense in which the condition passes zero
  double tolerance = 1e-9;                       ///< of the time, s
  bool once = true;                              ///< or at every crossing
  std::vector<std::string> activate{},           ///< names of joints and forces that become active
      deactivate{};                              ///< names of joints and forces that become inactive
  bool stop = false;                             ///< ends the run there
  /// Whether it can happen. A host may set it between two calls of a run: crossings while it is off are lost, and an
  /// event by time that falls into such an interval never happens.
  bool on = true;
  /// Any other change, except of the time and of active joints and forces; velocities are made consistent afterwards.
  /// If it throws, the state is as it was, and the event is due again when the run continues.
  std::function<void(State&)> change{};
};

// StepLoop: runs a mechanism. Makes steps, ends them at jumps, events and output times, accepts them, calls observers.

/// Limits beyond which the result of a run counts as wrong (EnergyAudit, recorder.h).
struct AuditLimits {
  double energy = 1e-3;  ///< imbalance, relative to the energy exchanged (Audit::scale)
  double violation = 0;  ///< |C|, m; 0: a thousandth of System::length()

  /// These limits with the violation filled in: as given, else a thousandth of `length`, m (System::length()).
  AuditLimits of(double length) const { return {energy, violation > 0 ? violation : 1e-3 * length}; }
};

/// Steps, tolerances and outputs of a run.
struct StepLoopOptions {
  double step = 0;        ///< fixed step, s; for adaptive methods the largest step (0: no limit)
  Tolerance tolerance{};  ///< for adaptive methods
  double output = 0;      ///< interval of output times from the start on, s, with the end as one more; 0: every step
  std::vector<double> output_times{};  ///< or these times, s, ascending; if given, `output` is ignored
  /// The run ends with a StepError after this many steps; 0: no such limit. In any case a run ends if its step size
  /// would need more than 1e9 steps.
  long max_steps = 0;
  double start_limit = 1e-6;  ///< a start that violates the constraints by more (m, m/s) is an error: assemble it first
  AuditLimits limits{};       ///< a violation beyond `violation` is reported once
};

/// The course of an event in a run.
struct EventCourse {
  std::string name;                                           ///< of the event
  double last = -std::numeric_limits<double>::infinity();     ///< when it happened last, s; below zero: never
  double nearest = std::numeric_limits<double>::quiet_NaN();  ///< value of its condition nearest to zero; NaN: it has
                                                              ///< none, or no step was made
  double at = std::numeric_limits<double>::quiet_NaN();       ///< time of that value, s
};

/// Counters, findings and the end of a run.
struct SimulationReport {
  long steps = 0,                                                ///< accepted steps
      rejected = 0;                                              ///< rejected attempts
  double largest_violation = 0;                                  ///< |C| after accepted steps, m
  long impacts = 0;                                              ///< times at which one-sided joints were hit
  long manifold_steps = 0;                                       ///< steps with projected stages
  double stiff_since = std::numeric_limits<double>::infinity();  ///< when damped fast modes first limited the steps, s
  double largest_turn = 0;  ///< rotation of a body within a step, rad; measured in fixed steps and implicit methods
  std::string turned_most;  ///< that body
  bool stopped = false;     ///< by events or by StepLoop::progress
  std::string stopped_by;   ///< names of the events, or "the caller"
  std::vector<Finding> findings{};  ///< in the order in which they came
};

/// Runs a mechanism: steps, events, contacts, outputs, observers.
///
/// An error during a run leaves the loop at its last accepted state, from which run_until() or step() continue:
/// observers that were not called for it yet are called, and events that are due happen. Exceptions of observers,
/// events and progress become UserCodeErrors, unless they are Errors. None of them may run the loop or set its state:
/// that is a ModelError.
class LOCKSTEP_API StepLoop {
 public:
  /// The run begins at System::start, unless set_state() sets another state. The dynamics must outlive the loop. Throws
  /// ModelError for a missing integrator, a missing fixed step, and options that are negative, not finite or not
  /// ascending.
  StepLoop(Dynamics& dynamics, std::unique_ptr<Integrator> method, StepLoopOptions options = {});
  ~StepLoop();

  /// Sets another start, for a new run: observers are started again, the report is cleared. Throws AssemblyError if
  /// it violates the constraints by more than the limit, ModelError if it does not fit the system.
  void set_state(State);
  const State& state() const { return state_; }                ///< at the present time
  Dynamics& dynamics() { return dynamics_; }                   ///< as given
  const System& system() const;                                ///< the mechanism
  Integrator& integrator() { return *method_; }                ///< as given

  void add_observer(Observer&);  ///< not owned; started at once if the run has begun
  /// Adds an event; the reference stays valid. A time before the start never comes. In a run that has begun, an event
  /// at the present time acts at the beginning of the next call, before its first step. Samples at the time of an event
  /// show the state just before it acts. Throws ModelError for an event without time or condition, for a past time in a
  /// run that has begun, for a tolerance that is not above zero, for a joint that is unknown or merged, and for a force
  /// that is not switched (Force::set_switched).
  Event& add_event(Event);
  /// Activates this joint or force at once, as an event of the present time would. Begins the run if it has not begun.
  /// The name of an event, if no joint or force has it, switches that event on (Event::on). Throws as add_event(), and
  /// AssemblyError for a joint that does not fit; the state is then as it was. After an error of contacts or observers
  /// the joint or force stays switched, and the next call continues with them.
  void activate(const std::string& name);
  /// Deactivates this joint or force, or switches this event off; as activate().
  void deactivate(const std::string& name);
  /// A number that forces and laws read (System::add_input), to be set between two steps; keep the reference. Throws
  /// ModelError with the closest name.
  ControlInput& input(const std::string& name);
  /// Called after every accepted step; returns false to end the run there.
  std::function<bool(const State&)> progress{};

  /// Called between two steps, when an accepted step is completed: here save() may be called.
  std::function<void()> between_steps{};

  /// Runs to the time t, s; may be called again for more. Throws ModelError for a t in the past, AssemblyError for a
  /// start that violates the constraints, StepError for an invalid step of a method (backwards, of length zero, too
  /// long, with other active joints), and what steps, events and observers throw; observers are finished first.
  const SimulationReport& run_until(double t);
  /// Runs on by exactly h, s, to the present time plus h, in as many steps as that takes; the method keeps its own step from
  /// call to call. As run_until(), but the end is no output by itself, and observers are not finished. Throws ModelError for
  /// an h that is negative, or below the round-off of the time.
  const SimulationReport& advance(double h);
  /// Makes one accepted step of at most h, s (0: that of the method or of the options). Throws what run_until() throws,
  /// but does not finish the observers.
  StepReport step(double h = 0);
  const SimulationReport& report() const { return report_; }  ///< of the run so far
  /// The events, in the order in which they were added: whether each happened, and how near its condition came to zero
  /// at the times at which it was evaluated, some in each step.
  std::vector<EventCourse> event_courses() const;

  /// Writes all data of the run between two steps: state, report, step control, history of the method, events, contacts
  /// and observers (Observer::save). Throws ModelError if the run has not begun, if an error left a step unfinished,
  /// and if the method or an observer does not save all its data (Integrator::saves_all, Observer::saves_all).
  void save(Snapshot&);
  /// Continues from there, in place of set_state(): with the same system, method, options, events and observers the run
  /// is then equal to the last bit to the one that was saved. One snapshot serves any number of runs, in any threads. Throws
  /// ModelError if a difference is found: the method's name, the options, the number of events and
  /// observers; names and types of bodies, joints and forces, masses, places of markers, gravity. The parameters of
  /// joints, forces, laws and events are not compared. A snapshot of another run, or with other events, leaves the run
  /// as it was; after a later error it begins again, at the state that it had, with inputs and events as they were
  /// read.
  void load(SnapshotReader);
  /// Adds a finding to the report and passes it to report_finding(). Throws ModelError for a code that finding_kinds()
  /// lacks.
  void add_finding(Finding);

 private:
  struct Parts;
  /// Calls `act` while no other call of the loop is allowed; after an error the method begins again.
  template <class Act>
  void exclusively(const char* what, Act&& act);
  /// First call of a run: start checked, method begun, observers started, events of this time. Later calls: the work
  /// that an error left undone.
  void start(bool begins = true);
  void start_run();
  void make_start();
  /// Steps to t, and the output of the end if it is due.
  void go_to(double t, bool with_output);
  /// One accepted step, not past `limit`, and all that depends on it.
  void make_step(double limit, double largest);
  /// Whether the method has to begin again, since inputs were set; changes of laws are settled.
  bool take_inputs();
  bool cross_inputs();
  void note_inputs();
  /// Inputs are those of a run that begins.
  void begin_inputs();
  /// The beginning of every call: the end that it runs to, s; infinity: none.
  void aim_at(double end);
  void switch_now(const char* call, const Event&);
  void settle_now();
  void begin_steps();
  void begin_method();
  /// Returns why no motion follows the jump; "" if one does.
  std::optional<AssemblyError> cross_jump(double t);
  void fire_events();
  bool apply_events(const std::vector<std::size_t>& due);
  void apply(const Event&, const std::string& who);
  void settle_contacts();
  void make_consistent(const std::string& cause);
  const Inputs* end_step(double wanted);
  void note_step(double t0, const Sample&);
  /// Does what is due after the last step (Parts::due), of which this is the end.
  void deliver(const Sample&);
  void deliver();
  void hand_over(Delivery&, const Sample&);
  void output_inside(Delivery&);
  void output(Delivery&, const Sample&);
  void output_end();
  /// To the coordinates of the formulation, if the method supports them, counting revolutions on from `near`; else to
  /// body coordinates.
  void to_coordinates(const State& near);
  /// Finishes the observers that were started. Returns the first error of theirs; null if there was none.
  std::exception_ptr finish();
  void measure_turns(double h, const Sample&);
  void warn_of_turns();
  void warn_at_start();
  void load_parts(SnapshotReader&);
  void warn_of_drift(double largest_before);

  Dynamics& dynamics_;
  std::unique_ptr<Integrator> method_;
  StepLoopOptions options_;
  State state_;
  std::vector<Observer*> observers_;
  SimulationReport report_;
  std::unique_ptr<Parts> parts_;
  bool begun_ = false, running_ = false, stale_ = false;  // stale: the method's history is that of a failed step
  bool warned_of_turns_ = false;
  bool has_laws_ = false;            // joints may read inputs, by laws
  bool keeps_stop_ = false;          // the last call switched: a stop that it reached still has to end a run
  std::vector<double> inputs_seen_;  // values of the inputs
};

}  // namespace lockstep
