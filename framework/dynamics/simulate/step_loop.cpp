// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/step_loop.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/along_laws.h"
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/keep_state.h"
#include "framework/dynamics/simulate/start_positions.h"
#include "framework/dynamics/simulate/step_loop_parts.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/finding_kinds.h"

namespace lockstep {

namespace {

void check_options(const StepLoopOptions& options, const IntegratorInfo& info) {
  const auto bad = [](double x) { return !std::isfinite(x) || x < 0; };
  if (bad(options.step)) throw ModelError(fmt::format("the step of {} s must be greater than 0", options.step));
  if (bad(options.output))
    throw ModelError(fmt::format("the output interval of {} s must be greater than 0", options.output));
  check_tolerance(options.tolerance);
  const std::vector<double>& times = options.output_times;
  if (!std::is_sorted(times.begin(), times.end()) ||
      !std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); }))
    throw ModelError("the output times must be finite and ascending; sort them");
  if (!info.adaptive && options.step == 0)
    throw ModelError(
        fmt::format("{} uses a fixed step, and none is given; set StepLoopOptions::step, or --step", info.name));
}

// Without rows nothing else would notice it before the first step.
void check_finite(const System& system, const State& state) {
  if (!std::isfinite(state.t))
    throw ModelError(fmt::format("StepLoop::set_state: the time is {}; it must be finite", state.t));
  for (int k = 0; k < system.n_slots(); ++k)
    if (!state.q.segment<7>(7 * k).allFinite() || !state.v.segment<6>(6 * k).allFinite())
      throw NonFiniteError(fmt::format("StepLoop::set_state: body '{}' has a position or velocity that is not finite",
                                       system.body_of_slot(k).name),
                           state.t);
  if (!state.s.allFinite())
    throw NonFiniteError("StepLoop::set_state: an integrated state of a joint, force or auxiliary is not finite",
                         state.t);
}

bool may_damp(const Force& force, const Inputs& in) try {
  return force.dissipation(in) != 0 || force.supply(in) != 0 || force.potential(in) == 0;
} catch (...) {
  return true;
}

// Whether anything may take energy out of motions at this state: Baumgarte's terms, a force that dissipates or supplies a
// power, or one that reports no energy or throws. If nothing does, a mode that decays has one that grows as fast, and no
// step is short for damped modes.
bool may_damp(Dynamics& dynamics, const State& state) {
  if (dynamics.options().stabilization.kind == Stabilization::Kind::baumgarte) return true;
  const Inputs& in = dynamics.inputs(state);
  return std::ranges::any_of(dynamics.system().forces(), [&](const auto& force) { return may_damp(*force, in); });
}

}  // namespace

StepLoop::StepLoop(Dynamics& dynamics, std::unique_ptr<Integrator> method, StepLoopOptions options)
    : dynamics_(dynamics), method_(std::move(method)), options_(std::move(options)) {
  if (!method_) throw ModelError("a step loop needs an integrator; take one from the registry");
  check_options(options_, method_->info());
  parts_ = std::make_unique<Parts>(*this);
  method_->set_tolerance(options_.tolerance);
  dynamics_.set_up();
  state_ = dynamics_.system().start();
}

StepLoop::~StepLoop() = default;

const System& StepLoop::system() const { return dynamics_.system(); }

ControlInput& StepLoop::input(const std::string& name) { return dynamics_.input(name); }

void StepLoop::set_state(State state) {
  exclusively("set_state", [&] {
    system().check_size(state);
    dynamics_.to_slots(state);
    check_finite(system(), state);
    check_start(dynamics_, state, options_.start_limit);
    state_ = std::move(state);
    report_ = {};
    begun_ = false, parts_->due = {}, parts_->started = 0;
  });
}

void StepLoop::add_observer(Observer& observer) {
  if (begun_) {
    const Sample sample(dynamics_, state_, parts_->interval.report());
    observer_code(observer, observers_.size(), state_.t, [&] { observer.start(sample); });
    ++parts_->started;
  }
  observers_.push_back(&observer);
}

Event& StepLoop::add_event(Event event) {
  if (begun_ && !event.value && event.at >= 0 && parts_->clock.is_past(event.at, state_.t))
    throw ModelError(
        {.thing = {.kind = "event", .name = event.name},
         .problem = fmt::format("its time of {:.9g} s is past, the run is at {:.9g} s", event.at, state_.t),
         .advice = "give the present time (state().t) or a later one",
         .t = state_.t});
  Event& added = parts_->events.add(std::move(event));
  if (begun_) parts_->events.join(state_);
  return added;
}

const SimulationReport& StepLoop::run_until(double t) {
  if (!std::isfinite(t) || t < state_.t)
    throw ModelError(fmt::format(
        "run_until: the end time of {} s must be finite and not before the present time of {} s", t, state_.t));
  exclusively("run_until", [&] {
    try {
      go_to(t, true);
    } catch (...) {
      finish();
      throw;
    }
    if (const std::exception_ptr of_observer = finish()) std::rethrow_exception(of_observer);
  });
  return report_;
}

const SimulationReport& StepLoop::advance(double h) {
  const double t = state_.t + h;
  if (!std::isfinite(t) || h < 0 || (h > 0 && t == state_.t))
    throw ModelError(fmt::format(
        "an advance of {} s from t = {} s must be greater than 0 and than the round-off of the time", h, state_.t));
  exclusively("advance", [&] { go_to(t, false); });
  return report_;
}

// A stop that a switching call came to is kept for the call that follows.
void StepLoop::aim_at(double end) {
  if (parts_->due.what == Due::nothing && !keeps_stop_) report_.stopped = false, report_.stopped_by.clear();
  keeps_stop_ = false;
  parts_->clock.set_end(end, state_.t);
}

void StepLoop::go_to(double t, bool with_output) try {
  aim_at(t);
  start();
  while (!report_.stopped && state_.t < t) {
    make_step(t, 0);
    if (between_steps) function_code("between_steps", between_steps, state_.t);
    if (parts_->events.any_due(state_.t)) settle_now();  // added meanwhile
  }
  if (with_output) output_end();
  warn_of_turns();
  parts_->interval.note_acting(state_);
} catch (const SolveError& e) {
  warn_of_turns();
  throw SolveError(fmt::format("{} (the last accepted state is at t = {:.9g} s)", e.what(), state_.t),
                   static_cast<const ErrorData&>(e));
} catch (...) {
  warn_of_turns();
  throw;
}

StepReport StepLoop::step(double h) {
  if (!std::isfinite(h) || h < 0)
    throw ModelError(fmt::format("a step of {} s must be greater than 0, or 0 for the method's choice", h));
  exclusively("step", [&] {
    aim_at(kNever);
    start();
    if (!report_.stopped) make_step(kNever, h);
    parts_->interval.note_acting(state_);
  });
  return parts_->interval.report();
}

// What an error left due comes first. A switching call acts before the method `begins`.
void StepLoop::start(bool begins) {
  dynamics_.set_up();
  system().check_size(state_);  // the system may have grown since
  if (!begun_) return start_run();
  deliver();
  const bool taken = take_inputs();
  if (stale_ && begins)
    begin_method(), stale_ = false;
  else if (!stale_ && (taken || parts_->interval.acts_otherwise(state_)))
    begin_steps();
  if (parts_->events.any_due(state_.t)) settle_now();
}

// A start that fails is made again, as if it had not been made.
void StepLoop::start_run() {
  const State state = state_;
  const SimulationReport report = report_;
  try {
    make_start();
  } catch (...) {
    keep_state(state, state_), report_ = report, begun_ = false, parts_->due = {};
    throw;
  }
}

void StepLoop::make_start() {
  Parts& p = *parts_;
  p.before_change = {}, p.along_laws.reset();
  system().check_size(state_);
  check_start(dynamics_, state_, options_.start_limit);
  if (dynamics_.options().formulation == Formulation::joint) refuse_joint(why_not_joint(dynamics_, state_, *method_));
  count_from(dynamics_, state_);
  dynamics_.accept(state_);
  p.interval.start(state_);
  p.clock.start(state_.t);
  p.events.start(state_.t);
  p.contacts.start(state_);
  if (!p.contacts.empty()) settle_contacts();
  begun_ = true;
  warned_of_turns_ = false;
  const Sample sample(dynamics_, state_, p.interval.report());
  for (p.started = 0; p.started < observers_.size(); ++p.started) {
    Observer& o = *observers_[p.started];
    observer_code(o, p.started, state_.t, [&] { o.start(sample); });
  }
  if (p.clock.output_due(state_.t)) p.fall_due(Due::only_row), deliver();
  to_coordinates(p.before_change);
  dynamics_.forget_rows(state_);  // only the start needs all of them
  begin_inputs();
  begin_method();
  stale_ = false;
  warn_at_start();
  if (!p.contacts.empty()) p.contacts.note(state_, true);
  p.fall_due(Due::events), deliver();
}

void StepLoop::warn_at_start() {
  const IntegratorInfo& method = parts_->interval.method();
  if (state_.coordinates && !state_.coordinates->has_rows() &&
      dynamics_.options().stabilization.kind != Stabilization::Kind::project)
    add_finding({&finding::setting_unused, "",
                 "stabilisation has no effect: joint coordinates satisfy the joints exactly",
                 "use formulation omega to see drift"});
  if (const double between = parts_->clock.shortest_output();
      !method.adaptive && !parts_->interval.has_dense() && options_.step > (1 + kNegligible) * between)
    add_finding({&finding::long_steps, "",
                 fmt::format("{} cannot interpolate: its steps of {:g} s are cut at the outputs, {:g} s apart",
                             method.name, options_.step, between),
                 "request fewer outputs, or use smaller steps", options_.step, between, "s"});
  for (const std::string& name : parts_->events.past_at_start())
    add_finding({&finding::event_at_zero, "event '" + name + "'",
                 fmt::format("event '{}': its condition has already passed zero at the start", name),
                 "it happens only when the condition passes zero again"});
}

// The step is computed, then it is final: from there on what is due of it is kept until it is done.
void StepLoop::make_step(double limit, double largest) {
  Parts& p = *parts_;
  StepInterval& interval = p.interval;
  const auto explained = [&](auto&& ask) {
    try {
      return ask();
    } catch (const StepError& error) {
      const double tolerance = p.clock.adaptive() ? options_.tolerance.relative : HUGE_VAL;
      try {
        throw StepError(error.what() + p.why_steps_end(dynamics_, state_, tolerance), state_.t);
      } catch (const NonFiniteError& cause) {
        throw NonFiniteError(cause.what() + (" (" + error.fact() + ")"), cause.data());
      }
    }
  };
  explained([&] { p.clock.check(state_.t, report_.steps); });
  if (!dynamics_.has_current_coordinates(state_))
    begin_method();  // the system was changed
  else if (take_inputs())
    begin_steps();
  const bool passing = interval.report().manifold;  // a singular position, of which the method keeps what it knows
  if (!passing && state_.coordinates && state_.coordinates->take_off_turns(state_)) interval.begin(state_);
  const double t0 = state_.t;
  p.target = p.clock.next_target(t0, limit, p.events.next_instant(t0), largest, interval.has_dense());
  const double wanted = explained([&] { return p.clock.step_towards(t0, p.target, largest); });
  interval.make(state_, wanted, !p.events.empty() || !p.contacts.empty());
  p.clock.count_step(wanted, interval.report());
  const Sample sample(dynamics_, state_, interval.report(), end_step(wanted));
  if (largest > 0) p.clock.set_anchor(state_.t);
  ++report_.steps, p.clock.last().add(state_.t);
  p.events.pass(state_.t);
  note_step(t0, sample);
  deliver(sample);
}

// The end of the step: its target, or before it if a contact or an event cuts it; and what is due there. An error takes
// the step back.
const Inputs* StepLoop::end_step(double wanted) {
  Parts& p = *parts_;
  const Clock::Target& target = p.target;
  bool landed = p.interval.report().h >= wanted && wanted == target.reach - p.interval.from().t;
  if (landed) state_.t = target.reach;
  try {
    p.finder.begin(state_);
    p.contacts.add_guards(state_), p.events.add_guards(state_);
    const bool is_cut = p.finder.find_and_cut(state_);
    const bool touched = p.contacts.meet(state_), met = p.events.meet(state_, is_cut);
    if ((met || touched) && state_.t < target.reach) landed = false;
    const bool jump = landed && target.jump;
    std::optional<AssemblyError> refusal = jump ? cross_jump(target.t) : std::nullopt;
    const Inputs* const seen = dynamics_.accept(state_);
    if (landed || met || touched) p.clock.set_anchor(state_.t);
    p.fall_due(Due::inside);
    if (touched || met || jump)
      p.change = {true, jump, touched ? "an impact" : jump ? p.jumping : "", std::move(refusal)};
    return seen;
  } catch (...) {
    keep_state(p.interval.from(), state_);
    p.events.forget_met();
    throw;
  }
}

// The report of a step that began at t0.
void StepLoop::note_step(double t0, const Sample& sample) {
  const StepReport& step = sample.report;
  for (const std::string& name : parts_->events.take_left_zero())
    add_finding({&finding::event_at_zero, "event '" + name + "'",
                 fmt::format("event '{}': its condition is zero at {}, which is no crossing", name,
                             report_.steps == 1 ? "the start" : fmt::format("t = {:.9g} s, when it was added", t0)),
                 "it happens only when the condition passes zero again"});
  measure_turns(step.h, sample);
  parts_->interval.measure(state_, report_.steps);
  report_.rejected += step.rejected;
  if (step.manifold) ++report_.manifold_steps;
  if (step.stiff && !(report_.stiff_since <= state_.t) && may_damp(dynamics_, state_)) report_.stiff_since = state_.t;
  const double largest_before = report_.largest_violation;
  if (!(step.violation_after <= report_.largest_violation)) report_.largest_violation = step.violation_after;
  warn_of_drift(largest_before);
}

// Crosses the last part of a step to a jump with the rates on its left side; the error is quadratic in its length. What
// the laws of a tree do on that side becomes the bodies' own.
std::optional<AssemblyError> StepLoop::cross_jump(double t) {
  if (state_.coordinates && !state_.coordinates->followed().empty()) parts_->to_slots(dynamics_, state_);
  const PositionJump jump(dynamics_, state_);
  cross_rest(dynamics_, state_, t, parts_->crossing);
  parts_->jumping = jump.cause(system(), state_);
  return jump.refusal(dynamics_, state_, options_.start_limit);
}

void StepLoop::begin_method() {
  begin_steps();
  parts_->events.watch(state_);
}

// For a state of the last step on which other forces or joints act.
void StepLoop::begin_steps() {
  Clock& clock = parts_->clock;
  to_coordinates(parts_->before_change);
  const double t = state_.t, horizon = clock.horizon(t);
  parts_->interval.begin(state_);
  double guess = 0;
  if (clock.adaptive() && horizon > 0)
    guess = named(*method_, t, [&] { return method_->first_step(dynamics_, state_, horizon); });
  clock.begin(t, guess);
}

void StepLoop::to_coordinates(const State& near) {
  const IntegratorInfo& info = parts_->interval.method();
  if (info.joint) dynamics_.to_formulation(state_, &near);
  if (!takes(*method_, info, state_.coordinates.get())) dynamics_.to_slots(state_);
}

}  // namespace lockstep
