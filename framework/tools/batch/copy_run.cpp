#include "framework/tools/batch/copy_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

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
  jumps_ = times.empty() ? std::vector<double>{} : system.breakpoints(t0, times.back());
  next_jump_ = 0;
}

bool OutputSchedule::jump_first() const { return next_jump_ < jumps_.size() && jumps_[next_jump_] < times_[next_]; }

double OutputSchedule::reach() const {
  if (!jump_first()) return times_[next_];
  const double t = jumps_[next_jump_];
  return t - 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), 1e-3);
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
  state.t = t;
  if (const std::string refusal = jump.refusal(dynamics, state, limit); !refusal.empty()) throw AssemblyError(refusal);
  make_consistent(dynamics, state, "the jump of a law", limit);
}

void watch_pace(Pace& pace, const RunTask& task, int copy, double end, double advised, double t, long n) {
  const bool adaptive = task.scheme.error != nullptr;
  const std::string slow = pace.watch({task.options.integrator, adaptive, end, advised, task.options.max_steps}, t, n);
  if (!slow.empty()) log_warning(fmt::format("copy {}: {}", copy, slow));
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

void run_alone(System& system, int copy, State state, OutputSchedule schedule, double h, const RunTask& task,
               CopyReport& report, Pace pace) {
  try {
    DynamicsOptions options;
    options.stabilization = task.options.stabilization;
    options.formulation = task.formulation;
    Dynamics dynamics(system, std::make_unique<SchurSolver>(), options);
    const std::unique_ptr<Integrator> integrator = task.make_integrator();
    const bool fixed = task.scheme.error == nullptr;
    integrator->set_tolerance(task.options.tolerance);
    dynamics.to_formulation(state);
    dynamics.accept(state);
    integrator->begin(dynamics, state);
    const auto tell_step = [&](bool jumped) {
      if (!task.step) return;
      State told = state;
      dynamics.to_slots(told);
      task.tell_step(copy, told, jumped);
    };
    const auto arrive = [&] {
      bool output = false;
      const double t = schedule.arrive(output);
      if (!output) {
        pass_jump(dynamics, state, t);
        dynamics.to_formulation(state);
        tell_step(true);
        return;
      }
      state.t = t;
      State told = state;
      dynamics.to_slots(told);
      task.tell(copy, schedule.next() - 1, told);
    };
    const double largest = task.options.max_step > 0 ? task.options.max_step : std::numeric_limits<double>::infinity();
    report.t = state.t;
    const double t_start = state.t;
    while (!schedule.done()) {
      while (!schedule.done() && schedule.reach() <= state.t) arrive();  // the start may be an output time
      if (schedule.done()) break;
      task.go_on_from(state.t);
      watch_pace(pace, task, copy, schedule.end(), h, state.t, report.steps);
      if (h > 0 && !fixed && step_is_round_off(h, state.t, schedule.end() - t_start))
        throw StepError(
            fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s", integrator->info().name, h, state.t),
            state.t);
      if (!(h > 0)) h = integrator->first_step(dynamics, state, std::min(largest, schedule.reach() - state.t));
      const double asked = schedule.step(state.t, std::min(h, largest), fixed);
      const bool lands = schedule.lands(state.t, asked);
      const StepReport step = integrator->step(dynamics, state, asked);
      dynamics.accept(state);
      if (state.coordinates) state.coordinates->take_off_turns(state);
      ++report.steps, report.rejected += step.rejected;
      if (step.h_next > 0) h = advised_after(h, asked, step.h, step.h_next);
      const bool landed = lands && step.h >= asked;
      if (landed) state.t = schedule.reach();
      report.t = state.t;
      tell_step(false);
      if (!landed) continue;
      arrive();
      report.t = state.t;
    }
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
  Pace pace;
  pace.start(start.t);
  run_alone(system, copy, start, schedule, task.options.step, task, report, pace);
}

}  // namespace lockstep::lanes
