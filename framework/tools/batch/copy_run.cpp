// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/copy_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/step_rules.h"

namespace lockstep::lanes {

void OutputSchedule::begin(const System& system, double t0, std::span<const double> times) {
  times_ = times;
  next_ = std::lower_bound(times.begin(), times.end(), t0) - times.begin();
  const double past_end = times.empty() ? t0 : std::nextafter(times.back(), HUGE_VAL);  // a jump at the very end, too
  passes::breakpoints(system, t0, past_end, jumps_);
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
  if (const auto refusal = jump.refusal(dynamics, state, limit)) throw AssemblyError(*refusal);
  make_consistent(dynamics, state, "the jump of a law", limit);
}

void check_length(const LastSteps& last, const RunTask& task, double end, double t, long n) {
  last.check({task.options.integrator, task.scheme.error != nullptr, t, end, n, task.options.max_steps});
}

namespace {

template <class Act>
void by_caller(Act&& act) {
  try {
    act();
  } catch (...) {
    throw CallerThrew{std::current_exception()};
  }
}

/// Counts the steps of a copy that runs alone, and hands them on. What is thrown there leaves the run as it is.
class Follower final : public Observer {
 public:
  Follower(int copy, Dynamics& dynamics, const RunTask& task, CopyReport& report)
      : copy_(copy), dynamics_(dynamics), task_(task), report_(report) {
    last_.begin(report.t);
  }
  void step(const Sample& sample) override {
    ++report_.steps, report_.rejected += sample.report.rejected;
    report_.t = sample.state.t, report_.unmet.count(sample.report, report_.t);
    last_.add(report_.t);
    tell(sample.state, false);
    if (report_.t < task_.times.back())
      guarded([&] {
        task_.go_on_from(report_.t);
        check_length(last_, task_, task_.times.back(), report_.t, report_.steps);
      });
  }
  void jumped(const Sample& sample) override { tell(sample.state, true); }
  bool threw() const { return threw_ != nullptr; }
  void rethrow() const {
    if (threw_) std::rethrow_exception(threw_);
  }

 private:
  void tell(const State& state, bool jumped) {
    if (task_.step) guarded([&] { task_.tell_step(copy_, dynamics_.in_slots(state), jumped); });
  }
  template <class Act>
  void guarded(Act&& act) try {
    if (!threw_) act();
  } catch (...) {
    threw_ = std::current_exception();
  }

  int copy_;
  Dynamics& dynamics_;
  const RunTask& task_;
  CopyReport& report_;
  LastSteps last_;
  std::exception_ptr threw_;
};

}  // namespace

Dynamics RunTask::dynamics_of(System& system) const {
  return Dynamics(system, std::make_unique<SchurSolver>(), {Formulation::joint, options.stabilization});
}

void RunTask::tell(int copy, std::size_t time, const State& state) const {
  by_caller([&] { output(copy, time, state); });
}

void RunTask::tell_step(int copy, const State& state, bool jumped) const {
  by_caller([&] { step(copy, state, jumped); });
}

void RunTask::go_on_from(double t) const {
  bool on = true;
  by_caller([&] { on = !go_on || go_on(t); });
  if (!on) throw StepError("stopped by the caller", t);
}

void run_alone(System& system, int copy, State state, std::size_t next, double start_limit, const RunTask& task,
               CopyReport& report) try {
  report.alone = true, report.t = state.t;
  Dynamics dynamics = task.dynamics_of(system);
  const double step = task.scheme.error ? task.options.max_step : task.options.step;
  StepLoop loop(dynamics, task.make_integrator(),
                {.step = step, .tolerance = task.options.tolerance, .start_limit = start_limit});
  Follower follower(copy, dynamics, task, report);
  loop.add_observer(follower);
  loop.set_state(std::move(state));
  loop.progress = [&](const State&) { return !follower.threw(); };
  task.go_on_from(report.t);
  for (; next < task.times.size(); ++next) {
    try {
      loop.run_until(task.times[next]);
    } catch (const Error&) {
      follower.rethrow();  // what the caller threw is the cause
      throw;
    }
    follower.rethrow();
    task.tell(copy, next, dynamics.in_slots(loop.state()));
  }
} catch (const Error& error) {
  report.finished = false;
  report.error = error.what();
}

}  // namespace lockstep::lanes
