// The orders that are measured: of the step, of the tolerance, of the dense output.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "framework/tools/check/integrator_check.h"
#include <lockstep/solvers.h>
#include <lockstep/error.h>

namespace lockstep {
namespace {

constexpr double kFloor = 2e-11;    // errors below it are rounding, and what projection leaves
constexpr double kCoarse = 3e-2;    // errors above it show no order yet
constexpr double kOrderRoom = 0.4;  // a measured order that is lower by more is another one

// Projects to round-off, so that fine steps show their error.
Dynamics exact_dynamics(System& system) {
  DynamicsOptions options;
  options.stabilization.tolerance = 1e-13;
  return Dynamics(system, std::make_unique<SchurSolver>(), options);
}

// Least squares of log e against log h.
double slope(const std::vector<double>& h, const std::vector<double>& e) {
  const auto n = static_cast<double>(h.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double x = std::log(h[i]), y = std::log(e[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double apart_of(const State& a, const State& b) { return (a.q - b.q).norm() + (a.v - b.v).norm(); }

}  // namespace

IntegratorCheck::Run IntegratorCheck::fixed_run(const ClosedMotion& motion, int n_steps) {
  Dynamics dynamics = exact_dynamics(*motion.system);
  const auto method = made();
  State state = motion.system->start();
  method->begin(dynamics, state);
  Run run{0, motion.end / n_steps, false};
  try {
    for (int i = 0; i < n_steps; ++i) {
      method->step(dynamics, state, run.h);
      dynamics.accept(state);
      run.error = std::max(run.error, motion.error(state));
    }
    run.fine = std::isfinite(run.error);
  } catch (const Error&) {  // the step is too coarse; a finer one follows
  }
  return run;
}

void IntegratorCheck::order_of_steps(const ClosedMotion& motion) {
  std::vector<Run> runs;
  for (int n = 4; n <= 8192; n *= 2) {
    const Run run = fixed_run(motion, n);
    if (run.fine && run.error < kFloor) break;
    if (run.fine && run.error < kCoarse) runs.push_back(run);
    if (runs.size() >= 4 && run.error < 1e-8) break;
  }
  if (runs.size() < 2) {
    add("converges", fmt::format("does not come near the closed form of the {} at any step", motion.name), "step()");
    return;
  }
  // the finest two halvings: the coarse ones may still be on their way
  const std::size_t first = runs.size() > 3 ? runs.size() - 3 : 0;
  std::vector<double> h, e;
  for (std::size_t i = first; i < runs.size(); ++i) h.push_back(runs[i].h), e.push_back(runs[i].error);
  judge_order(
      motion, slope(h, e),
      fmt::format("steps of {:.3g} to {:.3g} s, errors {:.2g} to {:.2g}", h.front(), h.back(), e.front(), e.back()));
}

void IntegratorCheck::judge_order(const ClosedMotion& motion, double measured, const std::string& how) {
  report_.compared(0);
  report_.note(fmt::format("order {:.2f} on the {} ({}), {} is told", measured, motion.name, how, info_.order));
  if (measured > info_.order - kOrderRoom) return;
  add("order",
      fmt::format("is of order {:.2f} on the {} ({}), and its info() tells {}", measured, motion.name, how,
                  info_.order),
      measured < 0.5
          ? "step(): the error does not fall at all"
          : "the coefficients, the times of the stages, the first steps of a multistep method, and order in info()",
      info_.order - measured);
}

IntegratorCheck::Run IntegratorCheck::adaptive_run(const ClosedMotion& motion, double tolerance) {
  Dynamics dynamics = exact_dynamics(*motion.system);
  const auto method = make_();
  method->set_tolerance({tolerance, 1e-2 * tolerance});
  State state = motion.system->start();
  method->begin(dynamics, state);
  double h = method->first_step(dynamics, state, motion.end);
  if (!(h > 0)) h = 1e-3;
  Run run;
  int n = 0;
  for (; state.t < motion.end && n < 200000; ++n) {
    const StepReport report = method->step(dynamics, state, h);
    dynamics.accept(state);
    run.error = std::max(run.error, motion.error(state));
    if (report.h_next > 0) h = report.h_next;
  }
  run.h = state.t / n;
  run.fine = std::isfinite(run.error) && state.t >= motion.end;
  return run;
}

void IntegratorCheck::order_of_tolerances(const ClosedMotion& motion) {
  std::vector<double> tolerances, h, e;
  for (int k = 3; k <= 11; ++k) {
    const double tolerance = std::pow(10.0, -k);
    const Run run = adaptive_run(motion, tolerance);
    if (!run.fine) {
      add("adaptive",
          fmt::format("does not come to the end of the {} at a tolerance of {:.0e}", motion.name, tolerance),
          "step() and StepReport::h_next");
      return;
    }
    if (run.error < kFloor) break;
    if (run.error < kCoarse) tolerances.push_back(tolerance), h.push_back(run.h), e.push_back(run.error);
  }
  if (e.size() < 3) {
    add("converges", fmt::format("does not come near the closed form of the {} at any tolerance", motion.name),
        "step()");
    return;
  }
  const double by_tolerance = slope(tolerances, e);
  report_.note(fmt::format("error on the {} as the tolerance to the power of {:.2f}", motion.name, by_tolerance));
  if (by_tolerance < 0.6 || by_tolerance > 1.7)
    add("tolerance",
        fmt::format("its error on the {} goes with the tolerance to the power of {:.2f}; 1 is wanted", motion.name,
                    by_tolerance),
        "set_tolerance(), the norm of the estimate and the exponent of the step-size control");
  judge_order(motion, slope(h, e),
              fmt::format("mean steps of {:.3g} to {:.3g} s, errors {:.2g} to {:.2g}", h.front(), h.back(), e.front(),
                          e.back()));
}

// The dense output of one step from the exact start: its ends, and how its error falls inside.
void IntegratorCheck::dense_output(const ClosedMotion& motion) {
  Dynamics dynamics = exact_dynamics(*motion.system);
  std::vector<double> h, e;
  State inside = motion.system->start();
  for (double wanted = 0.1; wanted > 2e-3; wanted *= 0.5) {
    const auto method = make_();
    method->set_tolerance({1e-3, 1e-3});
    State state = motion.system->start();
    const State start = state;
    method->begin(dynamics, state);
    if (!method->dense(state.t, inside)) return;
    if (apart_of(inside, start) > 1e-12)
      add("dense", "dense() right after begin() is not the state of begin()", "dense() before the first step");
    const double made = method->step(dynamics, state, wanted).h;
    if (!method->dense(start.t + 0.4 * made, inside)) {
      add("dense", "dense() has an answer right after begin() and none after a step", "dense(): always, or never");
      return;
    }
    if (std::abs(inside.t - start.t - 0.4 * made) > 1e-12)
      add("dense", "dense() at a time gives a state of another time", "dense(): out.t = t");
    const double error = motion.error(inside);
    if (error > 1e-13) h.push_back(made), e.push_back(error);
    for (const bool end : {false, true}) {
      if (!method->dense(end ? state.t : start.t, inside)) continue;
      const double gap = apart_of(inside, end ? state : start), room = end ? 1e-6 + 10 * motion.error(state) : 1e-10;
      if (gap > room)
        add("dense",
            fmt::format("dense() at the {} of a step of {:.3g} s is {:.3g} away from the state there ({})",
                        end ? "end" : "beginning", made, gap, motion.name),
            "dense() at the ends of the step");
    }
  }
  if (h.size() < 3) return;
  const double order = slope(h, e);
  report_.note(fmt::format("dense(): its error inside one step falls with the power {:.2f} of the step on the {}",
                           order, motion.name));
  if (order < 2.6)
    add("dense order",
        fmt::format("dense() inside a step falls only with the power {:.2f} of the step on the {}", order, motion.name),
        "dense(): a polynomial of order 2 at least; a method without one returns false");
}

}  // namespace lockstep
