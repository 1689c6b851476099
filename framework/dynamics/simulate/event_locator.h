// SPDX-License-Identifier: BSD-3-Clause
// EventLocator: the events of a run. Knows their instants and locates where a condition is met inside a step. Internal
// to the step loop.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/guard_finder.h"

namespace lockstep {

/// The force of this name; null: there is none.
const Force* force_named(const System&, const std::string& name);
/// Whether it does more than to end the run.
inline bool changes_state(const Event& e) { return !e.activate.empty() || !e.deactivate.empty() || e.change; }

/// The condition of a channel. `memory`, of one that depends on the states inside steps, is shown each step whole, and again
/// what remains of it.
struct LOCKSTEP_API ChannelCondition {
  std::function<double(const Sample&)> channel;
  double crosses;
  std::shared_ptr<Observer> memory;
  double operator()(const Sample& s) const { return channel(s) - crosses; }
};

class EventLocator : public GuardOwner {
 public:
  EventLocator(Dynamics& dynamics, StepInterval& interval, const Clock& clock, GuardFinder& finder)
      : dynamics_(dynamics), interval_(interval), clock_(clock), finder_(finder) {}

  /// Throws ModelError for an event without instant and condition, or with a link that cannot be switched.
  Event& add(Event);
  /// Throws ModelError for a link or force that cannot be switched; `who` switches it, in words.
  void check_switched(const Event&, const std::string& who) const;
  /// Turns the events of this name on or off; false for the name of a link or force. Throws ModelError for an unknown name.
  bool turn(const std::string& name, bool on);
  /// Starts the event added last in a run that has reached this state; it is gone again if its condition throws.
  void join(const State&);
  bool empty() const { return events_.empty(); }
  const Event& operator[](std::size_t i) const { return events_[i]; }

  /// Starts a new run at t: earlier events never happen.
  void start(double t);
  /// The next event by time after t; infinity: none.
  double next_instant(double t) const;
  /// Remembers every condition's value at this state.
  void watch(const State&);
  /// Adds conditions to the guards of the step that ended with this state.
  void add_guards(const State&);
  /// Whether one of them is met where the step ends now. `is_cut`: it ended later then.
  bool meet(const State&, bool is_cut);
  /// A step to t is accepted: events by time that were off up to then are missed.
  void pass(double t);

  /// Numbers of the events that happen at t; valid until the next call.
  const std::vector<std::size_t>& due(double t);
  /// Whether an event by time happens at t.
  bool any_due(double t) const;
  /// Forgets the conditions met in a step that was taken back.
  void forget_met();
  /// Event i has happened at t.
  void done(std::size_t i, double t);
  /// Names of the events that wait for a crossing in one sense whose far side the run starts on.
  std::vector<std::string> past_at_start() const;
  /// Names of the events whose condition was zero at the start, or where they joined the run, and that wait for a
  /// crossing in either sense, or in one sense to whose far side it went in the first step: reported once, after it.
  std::vector<std::string> take_left_zero();
  std::vector<EventCourse> courses() const;

  // -- checkpoints
  void save(Snapshot&) const;
  /// Throws ModelError if the events have other names or another order.
  void load(SnapshotReader&);

 private:
  struct Watched {
    double value = 0;                 ///< of its condition, at the beginning of the present step
    double last = -kNever;            ///< when it happened last
    Sampled nearest{kNever, kNever};  ///< to zero, of all that was seen
    bool over = false, met = false;
    bool first = true;  ///< no step was made yet since it is watched
    bool off = false;   ///< it was off in the last step, or when its condition was to be remembered
  };
  double guard(std::size_t event, const Sample&) override;
  double value_of(std::size_t event, const State&);
  bool reaches(double instant, double t) const { return instant <= t + clock_.same_instant(t); }
  bool by_time(std::size_t event, double t) const;
  void note_left_zero(const Guard&);
  void note_nearest(std::size_t k, double t);

  Dynamics& dynamics_;
  StepInterval& interval_;
  const Clock& clock_;
  GuardFinder& finder_;
  std::deque<Event> events_;  // a deque, so that references stay valid
  std::vector<Watched> watched_;
  std::vector<std::string> left_zero_;
  std::vector<std::size_t> due_;
};

}  // namespace lockstep
