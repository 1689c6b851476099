#include "framework/tools/batch/copy_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/step_rules.h"

namespace lockstep::lanes {

void OutputSchedule::begin(const System& system, double t0, std::span<const double> times) {
  times_ = times;
  next_ = static_cast<std::size_t>(std::lower_bound(times.begin(), times.end(), t0) - times.begin());
  jumps_ = times.empty() ? std::vector<double>{}
                         : system.breakpoints(t0, std::nextafter(times.back(), HUGE_VAL));  // one at the very end, too
  next_jump_ = 0;
  span_ = times.empty() ? 0.0 : times.back() - t0;
}

// An output at the jump is of its far side.
bool OutputSchedule::jump_first() const { return next_jump_ < jumps_.size() && jumps_[next_jump_] <= times_[next_]; }

double OutputSchedule::reach() const {
  if (!jump_first()) return times_[next_];
  const double t = jumps_[next_jump_];
  return t - before_jump(t, span_);
}

double OutputSchedule::step(double t, double h, bool equal) const {
  const double way = reach() - t;
  if (equal) return way / std::max(1.0, std::ceil(way / h - 1e-6));
  return step_within(way, h, 1e-4 * h);
}

bool OutputSchedule::lands(double t, double h) const { return t + h >= reach() - 1e-15 * std::abs(t); }

double OutputSchedule::arrive(bool& output) {
  output = !jump_first();
  return output ? times_[next_++] : jumps_[next_jump_++];
}

void pass_jump(Dynamics& dynamics, State& state, double t) {
  const double limit = StepLoopOptions().start_limit;
  dynamics.to_slots(state);
  const PositionJump jump(dynamics, state);
  StateRate rate = sized_like(state);
  cross_rest(dynamics, state, t, rate);
  if (const std::string refusal = jump.refusal(dynamics, state, limit); !refusal.empty()) throw AssemblyError(refusal);
  make_consistent(dynamics, state, "the jump of a law", limit);
}

void check_length(const LastSteps& last, const RunTask& task, double end, double t, long n) {
  last.check({task.options.integrator, task.scheme.error != nullptr, t, end, n, task.options.max_steps});
}

void check_copy(Dynamics& dynamics, const State& start) { check_start(dynamics, start, StepLoopOptions().start_limit); }

namespace {

template <class Act>
void by_caller(Act&& act) {
  try {
    act();
  } catch (...) {
    throw CallerThrew{std::current_exception()};
  }
}

}  // namespace

void RunTask::tell(int copy, std::size_t time, const State& state) const {
  by_caller([&] { output(copy, time, state); });
}

void RunTask::tell_step(int copy, const State& state, bool jumped) const {
  by_caller([&] { step(copy, state, jumped); });
}

void RunTask::go_on_from(double t) const {
  bool on = true;
  by_caller([&] { on = !go_on || go_on(t); });
  if (!on) throw StepError("broken off", t);
}

namespace {

/// The run of one copy by the scalar code.
class AloneRun {
 public:
  AloneRun(System& system, int copy, State state, OutputSchedule schedule, double h, const RunTask& task,
           CopyReport& report, const LastSteps& last)
      : copy_(copy),
        task_(task),
        report_(report),
        dynamics_(system, std::make_unique<SchurSolver>(), options_of(task)),
        integrator_(task.make_integrator()),
        state_(std::move(state)),
        schedule_(std::move(schedule)),
        last_(last),
        t_start_(state_.t),
        h_(h) {
    integrator_->set_tolerance(task.options.tolerance);
    if (task.options.max_step > 0) largest_ = task.options.max_step;
  }

  void run() {
    dynamics_.to_formulation(state_);
    dynamics_.accept(state_);
    integrator_->begin(dynamics_, state_);
    report_.t = state_.t;
    while (!schedule_.done()) {
      while (!schedule_.done() && schedule_.reach() <= state_.t) arrive();  // the start may be an output time
      if (schedule_.done()) break;
      task_.go_on_from(state_.t);
      check_length(last_, task_, schedule_.end(), state_.t, report_.steps);
      step();
    }
  }

 private:
  static DynamicsOptions options_of(const RunTask& task) {
    DynamicsOptions options;
    options.stabilization = task.options.stabilization;
    options.formulation = Formulation::joint;
    return options;
  }

  State in_slots() {
    State told = state_;
    dynamics_.to_slots(told);
    return told;
  }

  void tell_step(bool jumped) {
    if (task_.step) task_.tell_step(copy_, in_slots(), jumped);
  }

  // At the schedule's next instant.
  void arrive() {
    bool output = false;
    const double t = schedule_.arrive(output);
    if (output) {
      state_.t = t;
      task_.tell(copy_, schedule_.next() - 1, in_slots());
    } else {
      pass_jump(dynamics_, state_, t);
      dynamics_.to_formulation(state_);
      tell_step(true);
    }
    report_.t = state_.t;
  }

  void step() {
    const bool fixed = task_.scheme.error == nullptr;
    if (h_ > 0 && !fixed && step_is_round_off(h_, state_.t, schedule_.end() - t_start_))
      throw StepError(
          fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s", integrator_->info().name, h_, state_.t),
          state_.t);
    if (!(h_ > 0)) h_ = integrator_->first_step(dynamics_, state_, std::min(largest_, schedule_.reach() - state_.t));
    const double asked = schedule_.step(state_.t, std::min(h_, largest_), fixed);
    const bool lands = schedule_.lands(state_.t, asked);
    const StepReport step = integrator_->step(dynamics_, state_, asked);
    dynamics_.accept(state_);
    if (state_.coordinates) state_.coordinates->take_off_turns(state_);
    ++report_.steps, report_.rejected += step.rejected;
    last_.add(state_.t);
    if (step.h_next > 0) h_ = advised_after(h_, asked, step.h, step.h_next);
    const bool landed = lands && step.h >= asked;
    if (landed) state_.t = schedule_.reach();
    report_.t = state_.t;
    report_.unmet.count(step, state_.t);
    tell_step(false);
    if (landed) arrive();  // run() goes on where an output is at a jump
  }

  int copy_;
  const RunTask& task_;
  CopyReport& report_;
  Dynamics dynamics_;
  std::unique_ptr<Integrator> integrator_;
  State state_;
  OutputSchedule schedule_;
  LastSteps last_;
  double t_start_, h_;
  double largest_ = std::numeric_limits<double>::infinity();
};

}  // namespace

void run_alone(System& system, int copy, State state, OutputSchedule schedule, double h, const RunTask& task,
               CopyReport& report, const LastSteps& last) {
  try {
    AloneRun(system, copy, std::move(state), std::move(schedule), h, task, report, last).run();
  } catch (const Error& error) {
    report.finished = false;
    report.error = error.what();
  }
}

void start_alone(System& system, int copy, const State& start, const OutputSchedule& schedule, const RunTask& task,
                 CopyReport& report) {
  try {
    Dynamics dynamics(system, std::make_unique<SchurSolver>(), {Formulation::omega, task.options.stabilization});
    check_copy(dynamics, start);
  } catch (const Error& error) {
    report.finished = false, report.t = start.t, report.error = error.what();
    return;
  }
  LastSteps last;
  last.begin(start.t);
  run_alone(system, copy, start, schedule, task.options.step, task, report, last);
}

}  // namespace lockstep::lanes
