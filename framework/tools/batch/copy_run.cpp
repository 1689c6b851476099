#include "framework/tools/batch/copy_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
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

void run_alone(System& system, int copy, State state, OutputSchedule schedule, double h, const RunTask& task,
               CopyReport& report) {
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
      task.step(copy, told, jumped);
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
      task.output(copy, schedule.next() - 1, told);
    };
    const double largest = task.options.max_step > 0 ? task.options.max_step : std::numeric_limits<double>::infinity();
    report.t = state.t;
    const double t_start = state.t;
    long n_slow = 0;
    while (!schedule.done()) {
      while (!schedule.done() && schedule.reach() <= state.t) arrive();  // the start may be an output time
      if (schedule.done()) break;
      if (h > 0 && !fixed) {
        n_slow = schedule.end() - state.t > kMostSteps * h ? n_slow + 1 : 0;
        if (step_is_round_off(h, state.t, schedule.end() - t_start) || n_slow > kSlow)
          throw StepError(
              fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s", integrator->info().name, h, state.t),
              state.t);
      }
      if (!(h > 0)) h = integrator->first_step(dynamics, state, std::min(largest, schedule.reach() - state.t));
      const double asked = schedule.step(state.t, std::min(h, largest), fixed);
      const bool lands = schedule.lands(state.t, asked);
      const StepReport step = integrator->step(dynamics, state, asked);
      dynamics.accept(state);
      if (state.coordinates) state.coordinates->take_off_turns(state);
      ++report.steps, report.rejected += step.rejected;
      if (step.h_next > 0) h = advised_after(h, asked, step.h, step.h_next);
      report.t = state.t;
      tell_step(false);
      if (!lands || step.h < asked) continue;
      arrive();
      report.t = state.t;
    }
  } catch (const Error& error) {
    report.finished = false;
    report.error = error.what();
  }
}

}  // namespace lockstep::lanes
