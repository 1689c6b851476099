// What a step loop is made of, for the files that it is written in.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <cstddef>
#include <exception>
#include <string>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/contact_manager.h"
#include "framework/dynamics/simulate/event_locator.h"
#include "framework/dynamics/simulate/step_interval.h"
#include "framework/dynamics/simulate/told_again.h"
#include "framework/dynamics/simulate/user_code.h"

namespace lockstep {

class DetailObserver;

struct StepLoop::Parts {
  explicit Parts(StepLoop& of)
      : clock(of.system(), *of.method_, of.options_),
        interval(of.dynamics_, *of.method_),
        events(of.dynamics_, interval, clock),
        contacts(of.dynamics_, interval, clock, of.options_.start_limit) {}

  Clock clock;
  StepInterval interval;
  EventLocator events;
  ContactManager contacts;
  StateRate crossing;   // scratch for cross_jump
  State before_change;  // in the coordinates of the formulation: turns are counted on from there
  State before_events;
  std::size_t started = 0, told = 0;  // observers that were started, and told of the present phase
  struct {
    bool landed = false, met = false, touched = false, jump = false, due = false, moved = false;
    std::string refusal{};  // why no motion follows the jump; "" where one does
  } ended;                  // how the last step ended
  std::string cause;        // of the changes at its end

  std::vector<DetailObserver*> detailed;  // of the observers
  /// Shows states inside of the last step, from t0 to t1.
  void show_inside(DetailObserver& to, Dynamics& dynamics, double t0, double t1);
  /// Why the last steps do not reach the end of the run: the one-sided links that cut them; its length, if something turns by
  /// kLongStep radians in the next, or moves by as much of its size; else the body whose turn rounding keeps from this relative
  /// tolerance (infinite for fixed steps), and what varies most. For the end of a message: "" or "; ...".
  std::string why_steps_end(Dynamics& dynamics, const State& state, double tolerance) const;
  /// Whether something acts at the end of the last step, t: an impact, a law's jump, an event that changes something.
  bool acts(double t) const;
};

template <class Act>
void StepLoop::exclusively(const char* what, Act&& act) {
  if (running_)
    throw ModelError(fmt::format(
        "{} was called from inside the run, by an observer, an event or progress; call it when run_until has returned",
        what));
  struct Running {
    bool &running, &stale;
    const int before = std::uncaught_exceptions();
    ~Running() { running = false, stale = stale || std::uncaught_exceptions() > before; }
  } guard{running_, stale_};
  running_ = true;
  act();
}

// Calls all observers that were not called in this phase yet. One that throws was called, unless it asks to be told
// again.
template <class Call>
void StepLoop::tell(Call&& call) {
  std::size_t& told = parts_->told;
  for (; told < observers_.size(); ++told) {
    Observer& o = *observers_[told];
    take_asked_again(o);  // what somebody else made of it before
    try {
      call(o);
    } catch (...) {
      const std::size_t number = told;
      if (!take_asked_again(o)) ++told;
      rethrow_of_observer(o, number, phase_ == Phase::inside ? parts_->clock.next_output() : state_.t);
    }
  }
  told = 0;
}

}  // namespace lockstep
