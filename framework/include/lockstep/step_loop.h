// SPDX-License-Identifier: BSD-3-Clause
// The step loop, its events and observers.
#pragma once

#include <exception>
#include <functional>
#include <limits>
#include <memory>
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

// Observer: is called with the accepted states of a run; never changes them.

/// A state of a run as observers and channels see it. All are views, valid during the call; accelerations and
/// multipliers are solved for only when they are asked for.
class LOCKSTEP_API Sample {
 public:
  /// Of the state `s`, which the step `r` led to. All three must outlive it. `known`: its inputs, as Dynamics read them last;
  /// null: they are read at the first call of inputs().
  Sample(Dynamics& dynamics, const State& s, const StepReport& r, const Inputs* known = nullptr);
  const State& state;        ///< the state
  const StepReport& report;  ///< what the last step did
  /// What acted at this instant, to Observer::jumped: "event 'grab'", "a call", "an impact", "the jump of a law"; else "".
  std::string_view cause{};
  const System& system() const;  ///< the mechanism
  /// Accelerations, multipliers, rows and inputs at this state; solved at the first call. Throws what
  /// Dynamics::solution_at throws.
  const Solution& values() const;
  /// Accelerations alone: of values() where these are solved for already, else as Dynamics::accelerations() finds them at the
  /// first call.
  const VecX& accelerations() const;
  /// Motions of all slots, integrated states and memory at this state; read again only after those of another.
  const Inputs& inputs() const;
  /// Force and moment that a link exerts on the body of one of its markers, by Reactions::on_body_of; computed once for
  /// all channels that ask one after the other.
  const LinkWrench& wrench(const Lock& link, const Marker& at, int part = Reactions::kJoint) const;
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

/// Base of what watches a run: it is called with accepted states and never changes them. By default all calls do
/// nothing.
class LOCKSTEP_API Observer {
 public:
  virtual ~Observer();
  /// Called once at the start of a run.
  virtual void start(const Sample&);
  /// Called after every accepted step, with the state at its end.
  virtual void step(const Sample&);
  /// Called after step() where an event, an impact or the jump of a law acted at its end: at the same instant, with the
  /// state from which the run continues.
  virtual void jumped(const Sample&);
  /// Called at every output time (the times asked for, or every step when none were): the state interpolated by the
  /// method's dense output and projected, or the end of a step.
  virtual void output(const Sample&);
  /// Called at the end of every StepLoop::run_until, also when it throws.
  virtual void finish(const Sample&);
  /// Writes what it keeps from call to call, for a checkpoint. Default: nothing.
  virtual void save(Snapshot&) const;
  /// Takes back what save() wrote, in the same order; start() was called before, at the state of the checkpoint.
  /// Default: nothing.
  virtual void load(SnapshotReader&);
  /// Whether save() writes all that it keeps from call to call; false: runs with it have no checkpoints. Default: true.
  virtual bool saves_all() const;
  /// Whether it keeps rows: a call of output(), jumped() or DetailObserver::before_jump() that threw is then made again when
  /// the run goes on, so that no row is lost. Default: false, what it threw may be meant to break the run off.
  virtual bool keeps_rows() const;
};

// Event: changes the links in force or the state between two steps, by time or by a condition located to tolerance.

/// An instant at which links are switched, the state changes or the run ends.
struct Event {
  /// Sense in which the condition passes zero.
  enum class Crossing {
    any,     ///< either
    rising,  ///< from below
    falling  ///< from above
  };
  std::string name;  ///< for messages and SimulationReport::stopped_by
  /// By time: this instant, s, >= 0, and no condition. By condition: value(sample) passes zero in the given sense within
  /// a step. Passages to and fro inside a step are met too, where they last longer than a part of it: a quarter, or a
  /// turn of pi/8 of the body that turns fastest if that is shorter; 1/256 where laws alone move the mechanism. Shorter
  /// ones are, where the condition has one turning point in them. At no output is it beyond zero without having fired,
  /// but where it started there. Of methods without dense output passages are looked for along a cubic polynomial.
  double at = -1;
  std::function<double(const Sample&)> value{};  ///< the condition, or none
  Crossing crossing = Crossing::any;             ///< sense in which the condition passes zero
  double tolerance = 1e-9;                       ///< of the instant, s
  bool once = true;                              ///< or at every crossing
  std::vector<std::string> activate{},           ///< names of links that come into force and forces that act from now
      deactivate{};                              ///< names of links that are released and forces that cease to act
  bool stop = false;                             ///< ends the run there
  /// Whether it can happen. A host may set it between two calls of a run: what an event misses while it is off, it has
  /// missed; by time for good.
  bool on = true;
  /// Any other change, but for the time and what is in force; velocities are made consistent afterwards. If it throws,
  /// the state is as it was, and the event is due again when the run goes on.
  std::function<void(State&)> change{};
};

// StepLoop: runs a mechanism. Makes steps, ends them on jumps, events and output times, accepts them, calls observers.

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
  double output = 0;      ///< interval of output times from the start on, s, the end being one too; 0: every step
  std::vector<double> output_times{};  ///< or these instants, s, rising; if given, `output` is ignored
  /// The run is ended, with a StepError, when it has taken this many steps and is not done; 0: no such limit. Whatever
  /// it is, a run ends that would by its steps take more than a thousand million of them.
  long max_steps = 0;
  double start_limit = 1e-6;  ///< a start that violates the constraints by more (m, m/s) is refused: assemble it first
  AuditLimits limits{};       ///< a run that drifts off its constraints beyond `violation` warns of it, once
};

/// How far an event of a run has come.
struct EventCourse {
  std::string name;                                           ///< of the event
  double last = -std::numeric_limits<double>::infinity();     ///< when it happened last, s; below zero: never
  double nearest = std::numeric_limits<double>::quiet_NaN();  ///< value of its condition that was nearest to zero; NaN:
                                                              ///< it has none, or no step was made
  double at = std::numeric_limits<double>::quiet_NaN();       ///< when that was, s
};

/// Counters, findings and the end of a run.
struct SimulationReport {
  long steps = 0,                                                ///< accepted steps
      rejected = 0;                                              ///< rejected attempts
  double largest_violation = 0;                                  ///< |C| after accepted steps, m
  long impacts = 0;                                              ///< instants at which unilateral links were hit
  long manifold_steps = 0;                                       ///< steps with their stages on the constraints
  double stiff_since = std::numeric_limits<double>::infinity();  ///< when damped fast modes first limited the steps, s
  double largest_turn = 0;  ///< of a body within a step, rad; measured in fixed steps and of implicit methods
  std::string turned_most;  ///< that body
  bool stopped = false;     ///< by events or by StepLoop::progress
  std::string stopped_by;   ///< names of the events, or "the caller"
  std::vector<Finding> findings{};  ///< in the order in which they came
};

/// Runs a mechanism: steps, events, contacts, outputs, observers.
///
/// What is thrown during a run leaves the loop at its last accepted state, from which run_until() or step() go on:
/// observers that were not told of it yet are told, and events that are due happen. What the code of observers, events
/// and progress throws becomes a UserCodeError, unless it is an Error. None of them may run the loop or set its state:
/// that is a ModelError.
class LOCKSTEP_API StepLoop {
 public:
  /// The run begins at System::start, unless set_state() sets another state. The dynamics must outlive the loop. Throws
  /// ModelError for a missing integrator, a fixed step that is not given, and options that are negative, not finite or
  /// not rising.
  StepLoop(Dynamics& dynamics, std::unique_ptr<Integrator> method, StepLoopOptions options = {});
  ~StepLoop();

  /// Sets another start, for a new run: observers are started again, the report is cleared. Throws AssemblyError where
  /// it violates the constraints by more than the limit, ModelError where it does not fit the system.
  void set_state(State);
  const State& state() const { return state_; }                ///< at the present time
  Dynamics& dynamics() { return dynamics_; }                   ///< as given
  const System& system() const;                                ///< the mechanism
  Integrator& integrator() { return *method_; }                ///< as given

  void add_observer(Observer&);  ///< not owned; in a run that has begun it is started at once
  /// Adds an event; the reference stays valid. An instant before the start never comes. In a run that has begun one at
  /// the present time acts at the beginning of the next call, before its first step. Samples at the instant of an event show
  /// the state just before it acts. Throws ModelError for an event without instant or condition, for an instant that is past
  /// in a run that has begun, for a tolerance that is not above zero, for a link that is unknown or merged, and a force that
  /// is not switched (Force::set_switched).
  Event& add_event(Event);
  /// Brings this link into force, or has this force act, at once: with all that an event of the present time does to the
  /// state, but by this call. Begins the run if it has not begun. The name of an event, if no link or force has it, turns
  /// that event on (Event::on). Throws as add_event(), and AssemblyError for a link that does not fit; the state is then as
  /// it was. What contacts and observers throw afterwards leaves the switch made; the next call goes on with them.
  void activate(const std::string& name);
  /// Releases this link, has this force act no more, or turns this event off; as activate().
  void deactivate(const std::string& name);
  /// A number that forces and laws read (System::add_input), to be set between two steps; keep the reference. Throws
  /// ModelError with the closest name.
  ControlInput& input(const std::string& name);
  /// Called after every accepted step; returns false to end the run there.
  std::function<bool(const State&)> progress{};

  /// Called between two steps, when all that belongs to an accepted step is done: here save() may be called.
  std::function<void()> between_steps{};

  /// Runs on to the time t, s; may be called again for more. Throws ModelError for a t that lies in the past,
  /// AssemblyError for a start that violates the constraints, StepError for a step that no method may make (backwards,
  /// nowhere, too far, with other links in force), and what steps, events and observers throw; observers are finished
  /// first.
  const SimulationReport& run_until(double t);
  /// Runs on by exactly h, s, to the present time plus h, in as many steps as that takes; the method keeps its own step from
  /// call to call. As run_until(), but the end is no output by itself, and observers are not finished. Throws ModelError for
  /// an h that is negative, or lost beside the time.
  const SimulationReport& advance(double h);
  /// Makes one accepted step of at most h, s (0: the method's or the option's own). Throws what run_until() throws, but
  /// does not finish the observers.
  StepReport step(double h = 0);
  const SimulationReport& report() const { return report_; }  ///< of the run so far
  /// The events, in the order in which they were added: whether each happened, and how near its condition came to zero
  /// at the instants at which it was looked at, some of each step.
  std::vector<EventCourse> event_courses() const;

  /// Writes all that the run holds between two steps: state, report, step control, history of the method, events,
  /// contacts, and what the observers write themselves (Observer::save). Throws ModelError
  /// where the run has not begun, where an error left a step unfinished, and where the method or an observer does not
  /// save all that it keeps (Integrator::saves_all, Observer::saves_all).
  void save(Snapshot&);
  /// Goes on from there, in place of set_state(): with the same system, method, options, events and observers the run
  /// is then equal to the last bit to the one that was saved. One snapshot serves any number of runs, in any threads. Throws
  /// ModelError where one of them is seen to be another: the method's name, the options, the number of events and
  /// observers; names and types of bodies, links and forces, masses, places of markers, gravity. The parameters of links,
  /// forces, laws and events are not compared. A snapshot of another run, or with other events, leaves the run as it was;
  /// after a later error it begins anew, at the state that it had, with inputs and events as they were read.
  void load(SnapshotReader);
  /// Adds a finding to the report and hands it to report_finding(). Throws ModelError for a code that finding_kinds()
  /// lacks.
  void add_finding(Finding);

 private:
  struct Parts;
  /// Calls `act` while no other call of the loop is allowed; what it throws makes the method begin anew.
  template <class Act>
  void exclusively(const char* what, Act&& act);
  /// First call of a run: start checked, method begun, observers started, events of this very instant. Later calls: what
  /// an error left undone.
  void start(bool begins = true);
  void start_run();
  void make_start();
  /// Steps to t, and the output of the end if it is due.
  void go_to(double t, bool with_output);
  /// One accepted step, not past `limit`, and all that depends on it.
  void make_step(double limit, double largest);
  /// Whether the method is to begin anew, since inputs were set; what that changes of laws is settled.
  bool take_inputs();
  bool cross_inputs();
  void note_inputs();
  /// Inputs are those of a run that begins.
  void begin_inputs();
  /// What every call begins with: the end that it runs to, s; infinity: none.
  void aim_at(double end);
  void switch_now(const char* call, const Event&);
  void settle_now();
  void begin_steps();
  void begin_method();
  /// Returns why no motion follows the jump; "" where one does.
  std::string cross_jump(double t);
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
  /// To the coordinates of the formulation, where the method takes them, counting on from the turns of `near`; else to the
  /// slots' own.
  void to_coordinates(const State& near);
  /// Finishes the observers that were started. Returns the first error of theirs; null where there was none.
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
  bool has_laws_ = false;            // links may read inputs, by laws
  bool keeps_stop_ = false;          // the last call switched: a stop that it came to is still to end a run
  std::vector<double> inputs_seen_;  // values of the inputs
};

}  // namespace lockstep
