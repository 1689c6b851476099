#include "framework/tools/batch/copy_run.h"

#include <algorithm>
#include <cmath>

#include "framework/dynamics/solvers/schur_solver.h"
#include "framework/foundation/support/error.h"

namespace lockstep::lanes {

void Course::begin(const System& system, double t0, std::span<const double> times) {
  times_ = times;
  next_ = static_cast<std::size_t>(std::lower_bound(times.begin(), times.end(), t0) - times.begin());
  jumps_ = times.empty() ? std::vector<double>{} : system.breakpoints(t0, times.back());
  next_jump_ = 0;
}

bool Course::jump_first() const { return next_jump_ < jumps_.size() && jumps_[next_jump_] < times_[next_]; }

double Course::reach() const {
  if (!jump_first()) return times_[next_];
  const double t = jumps_[next_jump_];
  return t - 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), 1e-3);
}

double Course::step(double t, double h, bool equal) const {
  const double way = reach() - t;
  if (equal) return way / std::max(1.0, std::ceil(way / h - 1e-6));
  if (way <= 1.0001 * h) return way;
  return way < 2 * h ? 0.5 * way : h;
}

double Course::arrive(bool& wanted) {
  wanted = !jump_first();
  return wanted ? times_[next_++] : jumps_[next_jump_++];
}

void run_alone(System& system, int copy, State state, Course course, double h, const RunTask& task,
               CopyReport& report) {
  try {
    DynamicsOptions options;
    options.stabilization = task.options.stabilization;
    Dynamics dynamics(system, std::make_unique<SchurSolver>(), options);
    const std::unique_ptr<Integrator> integrator = task.make_integrator();
    const bool fixed = task.scheme.error == nullptr;
    integrator->set_tolerance(task.options.tolerance);
    dynamics.accept(state);
    integrator->begin(dynamics, state);
    const double largest = task.options.max_step > 0 ? task.options.max_step : std::numeric_limits<double>::infinity();
    report.t = state.t;
    while (!course.done()) {
      while (!course.done() && course.reach() <= state.t) {  // the start may be wanted
        bool wanted = false;
        state.t = course.arrive(wanted);
        if (wanted) task.output(copy, course.next() - 1, state);
      }
      if (course.done()) break;
      if (!(h > 0)) h = integrator->first_step(dynamics, state, std::min(largest, course.reach() - state.t));
      const double asked = course.step(state.t, std::min(h, largest), fixed);
      const bool lands = state.t + asked >= course.reach() - 1e-15 * std::abs(state.t);
      const StepReport step = integrator->step(dynamics, state, asked);
      dynamics.accept(state);
      ++report.steps, report.rejected += step.rejected;
      if (step.h_next > 0) h = asked < h && step.rejected == 0 ? std::max(h, step.h_next) : step.h_next;
      report.t = state.t;
      if (!lands || step.h < asked) continue;
      bool wanted = false;
      report.t = state.t = course.arrive(wanted);
      if (wanted) task.output(copy, course.next() - 1, state);
    }
  } catch (const Error& error) {
    report.finished = false;
    report.error = error.what();
  }
}

}  // namespace lockstep::lanes
