// SPDX-License-Identifier: BSD-3-Clause
// What a step loop is made of, for the files that it is written in.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/simulate/event_locator.h"
#include "framework/dynamics/simulate/keep_state.h"
#include "framework/dynamics/simulate/step_interval.h"
#include "framework/dynamics/simulate/user_code.h"
#include "framework/foundation/support/at_end.h"

namespace lockstep {

/// What is due after a step, one after the other up to `jumped`, or a row alone. It is done with when it did not throw.
enum class Due {
  inside,       ///< Observer::inside
  rows,         ///< the outputs inside the step
  step,         ///< Observer::step
  row,          ///< the output at its end
  progress,     ///< StepLoop::progress, asked once
  before_jump,  ///< Observer::before_jump, if something acts
  jump,         ///< velocities and coordinates after the jump of a law
  events,       ///< the events that fall due
  contacts,     ///< impacts, contacts and releases
  jumped,       ///< Observer::jumped, if something acted
  only_row,     ///< the output of the start or end of a run
  nothing
};

struct Delivery {
  Due what = Due::nothing;
  std::size_t called = 0;  ///< so many observers were called

  void go_on() { *this = {what < Due::jumped ? static_cast<Due>(static_cast<int>(what) + 1) : Due::nothing}; }
};

/// What changed the state at the end of a step, or between two.
struct StateChange {
  bool acted = false;     ///< something did,
  bool jump = false;      ///< a law jumps
  std::string cause{};    ///< and what, in words
  std::optional<AssemblyError> refusal{};  ///< why no motion follows the jump of a law
};

struct StepLoop::Parts {
  explicit Parts(StepLoop& of)
      : clock(of.system(), *of.method_, of.options_),
        interval(of.dynamics_, *of.method_),
        finder(of.dynamics_, interval, clock),
        events(of.dynamics_, interval, clock, finder),
        contacts(of.dynamics_, interval, finder, of.options_.start_limit) {}

  Clock clock;
  StepInterval interval;
  GuardFinder finder;
  EventLocator events;
  ContactManager contacts;
  StateRate crossing;       // scratch for cross_jump
  std::string jumping;      // what jumped last, in words
  State before_change;      // in the coordinates of the formulation: revolutions are counted on from there
  State kept;               // of or_as_before
  Clock::Target target;     // of the present step
  std::size_t started = 0;  // observers that were started
  Delivery due;             // after the last step; what threw stays until the run continues
  StateChange change;       // at its end
  std::optional<bool> along_laws;  // whether laws alone move the mechanism, until the active joints may change

  const Event* by_call = nullptr;  // what a call switches

  /// From now on this is due, and what follows it.
  void fall_due(Due first, StateChange at_end) { change = std::move(at_end), due = {first}; }
  /// Likewise, and nothing changed the state.
  void fall_due(Due first) {
    change.acted = change.jump = false, change.cause.clear(), change.refusal.reset(), due = {first};
  }
  /// Calls `act`; what it throws leaves the state as it was.
  template <class Act>
  auto or_as_before(State& state, Act&& act) {
    keep_state(state, kept);
    try {
      return act();
    } catch (...) {
      keep_state(kept, state);
      throw;
    }
  }
  /// To the slots' own coordinates, from where revolutions are counted on.
  void to_slots(Dynamics& dynamics, State& state) {
    if (state.coordinates) keep_state(state, before_change), dynamics.to_slots(state);
  }
  /// Why the last steps do not reach the end of the run: the one-sided joints that cut them; its length, if something
  /// rotates by kLongStep rad in the next step, or moves by as much of its size; else the body whose rotation cannot
  /// meet this relative tolerance (infinite for fixed steps), and what varies most. Ends a message: "" or "; ...".
  std::string why_steps_end(Dynamics& dynamics, const State& state, double tolerance) const;
  /// Whether something acts at the end of the last step, t: an impact, a law's jump, an event that changes something, a call.
  bool acts(double t);
};

template <class Act>
void StepLoop::exclusively(const char* what, Act&& act) {
  if (running_)
    throw ModelError(fmt::format(
        "{} was called inside the run, by an observer, an event or progress; call it after run_until has returned",
        what));
  const AtEnd ended([this, before = std::uncaught_exceptions()] {
    running_ = false, stale_ = stale_ || std::uncaught_exceptions() > before;
  });
  running_ = true;
  act();
}

/// The first item, "a; b", in which a checkpoint's signature differs from that of the run, in words.
LOCKSTEP_API std::string first_difference(const std::string& saved, const std::string& now);

}  // namespace lockstep
