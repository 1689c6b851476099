#include "framework/tools/check/integrator_orders.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/solvers.h>

namespace lockstep {
namespace {

constexpr double kFloor = 2e-11;    // smaller errors are rounding, and the tolerance of the projection
constexpr double kCoarse = 3e-2;    // larger errors do not show an order yet
constexpr double kOrderRoom = 0.4;  // by which a measured order may be lower than the stated one

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

double apart(const State& a, const State& b) { return (a.q - b.q).norm() + (a.v - b.v).norm(); }

/// A run at one step or tolerance.
struct Run {
  double error = 0, h = 0;  ///< largest error after a step; mean step, s
  bool complete = false;    ///< it reached its end with finite numbers
};

Run fixed_run(const IntegratorMaker& make, const ClosedMotion& motion, int n_steps) {
  Dynamics dynamics = exact_dynamics(*motion.system);
  const auto method = make();
  method->set_tolerance({1e-7, 1e-9});  // of an implicit method's iteration
  State state = motion.system->start();
  method->begin(dynamics, state);
  Run run{0, motion.end / n_steps};
  try {
    for (int i = 0; i < n_steps; ++i) {
      method->step(dynamics, state, run.h);
      dynamics.accept(state);
      run.error = std::max(run.error, motion.error(state));
    }
    run.complete = std::isfinite(run.error);
  } catch (const Error&) {  // the step is too large
  }
  return run;
}

/// Steps (or tolerances) and errors of the runs that show an order.
struct MeasuredError {
  std::vector<double> settings, h, errors;
  void add(double setting, const Run& run) {
    settings.push_back(setting), h.push_back(run.h), errors.push_back(run.error);
  }
};

void judge_order(const IntegratorInfo& info, const ClosedMotion& motion, const MeasuredError& m, const char* steps,
                 CheckReport& report) {
  const double order = slope(m.h, m.errors);
  report.compared(0);
  report.note(fmt::format("order {:.2f} on the {} ({} of {:.3g} to {:.3g} s, errors {:.2g} to {:.2g}), {} is told",
                          order, motion.name, steps, m.h.front(), m.h.back(), m.errors.front(), m.errors.back(),
                          info.order));
  if (order > info.order - kOrderRoom) return;
  report.add(
      "order",
      {fmt::format("is of order {:.2f} on the {} ({} of {:.3g} to {:.3g} s, errors {:.2g} to {:.2g}), and its "
                   "info() tells {}",
                   order, motion.name, steps, m.h.front(), m.h.back(), m.errors.front(), m.errors.back(), info.order),
       order < 0.5 ? "step(): the error does not fall at all"
                   : "the coefficients, the times of the stages, the first steps of a multistep method, and "
                     "order in info()"},
      info.order - order);
}

void check_fixed(const IntegratorMaker& make, const IntegratorInfo& info, const ClosedMotion& motion,
                 CheckReport& report) {
  MeasuredError all;
  for (int n = 4; n <= 8192; n *= 2) {
    const Run run = fixed_run(make, motion, n);
    if (run.complete && run.error < kFloor) break;
    if (run.complete && run.error < kCoarse) all.add(run.h, run);
    if (all.h.size() >= 4 && run.error < 1e-8) break;
  }
  if (all.h.size() < 2) {
    report.add("converges",
               {fmt::format("does not come near the closed form of the {} at any step", motion.name), "step()"});
    return;
  }
  if (all.h.size() > 3)  // the last two halvings: coarser runs may not show the order yet
    for (std::vector<double>* v : {&all.settings, &all.h, &all.errors}) v->erase(v->begin(), v->end() - 3);
  judge_order(info, motion, all, "steps", report);
}

Run adaptive_run(const IntegratorMaker& make, const ClosedMotion& motion, double tolerance) {
  Dynamics dynamics = exact_dynamics(*motion.system);
  const auto method = make();
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
  run.complete = std::isfinite(run.error) && state.t >= motion.end;
  return run;
}

void check_adaptive(const IntegratorMaker& make, const IntegratorInfo& info, const ClosedMotion& motion,
                    CheckReport& report) {
  MeasuredError all;
  for (int k = 3; k <= 11; ++k) {
    const double tolerance = std::pow(10.0, -k);
    const Run run = adaptive_run(make, motion, tolerance);
    if (!run.complete) {
      report.add("adaptive",
                 {fmt::format("does not come to the end of the {} at a tolerance of {:.0e}", motion.name, tolerance),
                  "step() and StepReport::h_next"});
      return;
    }
    if (run.error < kFloor) break;
    if (run.error < kCoarse) all.add(tolerance, run);
  }
  if (all.h.size() < 3) {
    report.add("converges",
               {fmt::format("does not come near the closed form of the {} at any tolerance", motion.name), "step()"});
    return;
  }
  const double power = slope(all.settings, all.errors);
  report.note(fmt::format("error on the {} as the tolerance to the power of {:.2f}", motion.name, power));
  if (power < 0.6 || power > 1.7)
    report.add("tolerance",
               {fmt::format("its error on the {} goes with the tolerance to the power of {:.2f}; 1 is wanted",
                            motion.name, power),
                "set_tolerance(), the norm of the estimate and the exponent of the step-size control"});
  judge_order(info, motion, all, "mean steps", report);
}

}  // namespace

void check_order(const IntegratorMaker& make, const IntegratorInfo& info, const ClosedMotion& motion,
                 CheckReport& report) {
  (info.adaptive ? check_adaptive : check_fixed)(make, info, motion, report);
}

void check_dense_output(const IntegratorMaker& make, const ClosedMotion& motion, CheckReport& report) {
  const auto add = [&](const char* key, std::string what, const char* look) {
    report.add(key, {std::move(what), look});
  };
  Dynamics dynamics = exact_dynamics(*motion.system);
  std::vector<double> h, e;
  State inside = motion.system->start();
  for (double wanted = 0.1; wanted > 2e-3; wanted *= 0.5) {
    const auto method = make();
    method->set_tolerance({1e-3, 1e-3});
    State state = motion.system->start();
    const State start = state;
    method->begin(dynamics, state);
    if (!method->dense(state.t, inside)) return;
    if (apart(inside, start) > 1e-12)
      add("dense", "dense() right after begin() is not the state of begin()", "dense() before the first step");
    const double h_made = method->step(dynamics, state, wanted).h;
    if (!method->dense(start.t + 0.4 * h_made, inside)) {
      add("dense", "dense() has an answer right after begin() and none after a step", "dense(): always, or never");
      return;
    }
    if (std::abs(inside.t - start.t - 0.4 * h_made) > 1e-12)
      add("dense", "dense() at a time gives a state of another time", "dense(): out.t = t");
    const double error = motion.error(inside);
    if (error > 1e-13) h.push_back(h_made), e.push_back(error);
    for (const bool end : {false, true}) {
      if (!method->dense(end ? state.t : start.t, inside)) continue;
      const double gap = apart(inside, end ? state : start), room = end ? 1e-6 + 10 * motion.error(state) : 1e-10;
      if (gap > room)
        add("dense",
            fmt::format("dense() at the {} of a step of {:.3g} s is {:.3g} away from the state there ({})",
                        end ? "end" : "beginning", h_made, gap, motion.name),
            "dense() at the ends of the step");
    }
  }
  if (h.size() < 3) return;
  const double order = slope(h, e);
  report.note(fmt::format("dense(): its error inside one step falls with the power {:.2f} of the step on the {}", order,
                          motion.name));
  if (order < 2.6)
    add("dense order",
        fmt::format("dense() inside a step falls only with the power {:.2f} of the step on the {}", order, motion.name),
        "dense(): a polynomial of order 2 at least; a method without one returns false");
}

}  // namespace lockstep
