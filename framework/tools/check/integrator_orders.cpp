// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/check/closed_motion.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <vector>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {
namespace {

constexpr double kFloor = 2e-11;    // smaller errors are rounding, and the tolerance of the projection
constexpr double kCoarse = 3e-2;    // larger errors do not show an order yet
constexpr double kOrderRoom = 0.4;  // by which a measured order may be lower than the stated one

// Projects to round-off, so that fine steps show their error.
const DynamicsOptions kExact{.stabilization = {.tolerance = 1e-13}};

// The power with which e goes with h: least squares of their logarithms.
double slope(const std::vector<double>& h, const std::vector<double>& e) {
  using Numbers = Eigen::Map<const Eigen::ArrayXd>;
  const auto n = static_cast<Eigen::Index>(h.size());
  const Eigen::ArrayXd x = Numbers(h.data(), n).log(), from_mean = x - x.mean();
  return (from_mean * Numbers(e.data(), n).log()).sum() / from_mean.square().sum();
}

double apart(const State& a, const State& b) { return (a.q - b.q).norm() + (a.v - b.v).norm(); }

/// A run at one step or tolerance.
struct Run {
  double error = 0, h = 0;  ///< largest error after a step; mean step, s
  bool complete = false;    ///< it reached its end with finite numbers
};

// `setting`: the step, or the tolerance of an adaptive method.
Run run(const IntegratorMaker& make, const IntegratorInfo& info, const ClosedMotion& motion, double setting) {
  constexpr int kMostSteps = 200000;
  // with fixed steps, the tolerance is that of an implicit method's iteration
  Going going(make, motion, tolerance_of(info.adaptive ? setting : 1e-7), kExact);
  const State& state = going.state;
  double h = info.adaptive ? going.method->first_step(going.dynamics, state, motion.end) : setting;
  if (!(h > 0)) h = 1e-3;
  Run run;
  const double end = motion.end - (info.adaptive ? 0 : 0.5 * setting);
  int n = 0;
  try {
    for (; state.t < end && n < kMostSteps; ++n) {
      const StepReport report = going.step(h);
      going.dynamics.accept(going.state);
      run.error = std::max(run.error, motion.error(state));
      if (report.h_next > 0 && info.adaptive) h = report.h_next;
    }
  } catch (const Error&) {  // a fixed step may be too large
    if (info.adaptive) throw;
    return run;
  }
  run.h = state.t / n;
  run.complete = std::isfinite(run.error) && state.t >= end;
  return run;
}

}  // namespace

void check_order(const IntegratorMaker& make, const IntegratorInfo& info, const ClosedMotion& motion,
                 CheckReport& report) {
  std::vector<double> settings, h, errors;  // of the runs that show an order
  for (int k = 0; k < (info.adaptive ? 9 : 12); ++k) {
    const double setting = info.adaptive ? std::pow(10.0, -3 - k) : std::ldexp(motion.end, -2 - k);
    const Run found = run(make, info, motion, setting);
    if (!found.complete && !info.adaptive) continue;
    if (!found.complete)
      return report.add(
          "adaptive", {fmt::format("does not come to the end of the {} at a tolerance of {:.0e}", motion.name, setting),
                       "step() and StepReport::h_next"});
    if (found.error < kFloor) break;
    if (found.error < kCoarse) settings.push_back(setting), h.push_back(found.h), errors.push_back(found.error);
    if (!info.adaptive && h.size() >= 4 && found.error < 1e-8) break;
  }
  if (h.size() < (info.adaptive ? 3 : 2))
    return report.add("converges", {fmt::format("does not come near the closed form of the {} at any {}", motion.name,
                                                info.adaptive ? "tolerance" : "step"),
                                    "step()"});
  if (info.adaptive) {
    const double power = slope(settings, errors);
    report.note(fmt::format("error on the {} as the tolerance to the power of {:.2f}", motion.name, power));
    if (power < 0.6 || power > 1.7)
      report.add("tolerance",
                 {fmt::format("its error on the {} goes with the tolerance to the power of {:.2f}; 1 is wanted",
                              motion.name, power),
                  "set_tolerance(), the norm of the estimate and the exponent of the step-size control"});
  } else if (h.size() > 3) {  // the last two halvings: coarser runs may not show the order yet
    h.erase(h.begin(), h.end() - 3), errors.erase(errors.begin(), errors.end() - 3);
  }
  const double order = slope(h, errors);
  const std::string measured =
      fmt::format("order {:.2f} on the {} ({} of {:.3g} to {:.3g} s, errors {:.2g} to {:.2g})", order, motion.name,
                  info.adaptive ? "mean steps" : "steps", h.front(), h.back(), errors.front(), errors.back());
  report.compared(0);
  report.note(fmt::format("{}, {} is told", measured, info.order));
  if (!(order > info.order - kOrderRoom))
    report.add("order",
               {fmt::format("is of {}, and its info() tells {}", measured, info.order),
                order < 0.5 ? "step(): the error does not fall at all"
                            : "the coefficients, the times of the stages, the first steps of a multistep method, and "
                              "order in info()"},
               info.order - order);
}

void check_dense_output(const IntegratorMaker& make, const ClosedMotion& motion, CheckReport& report) {
  const auto add = [&](const char* key, std::string what, const char* look) {
    report.add(key, {std::move(what), look});
  };
  std::vector<double> h, e;
  State inside = motion.system->start();
  for (double wanted = 0.1; wanted > 2e-3; wanted *= 0.5) {
    Going going(make, motion, {1e-3, 1e-3}, kExact);
    const State start = going.state;
    if (!going.method->dense(start.t, inside)) return;
    if (apart(inside, start) > kRoundOff)
      add("dense", "dense() right after begin() is not the state of begin()", "dense() before the first step");
    const double h_made = going.step(wanted).h;
    for (const double share : {0.0, 0.4, 1.0}) {
      const double t = start.t + share * h_made;
      if (!going.method->dense(t, inside))
        return add("dense", "dense() has an answer right after begin() and none after a step",
                   "dense(): always, or never");
      if (std::abs(inside.t - t) > kRoundOff)
        add("dense", "dense() at a time gives a state of another time", "dense(): out.t = t");
      const double error = motion.error(inside), gap = apart(inside, share == 0 ? start : going.state);
      if (share == 0.4 && error > 1e-13) h.push_back(h_made), e.push_back(error);
      if (share != 0.4 && gap > (share == 0 ? 1e-10 : 1e-6 + 10 * motion.error(going.state)))
        add("dense",
            fmt::format("dense() at the {} of a step of {:.3g} s is {:.3g} away from the state there ({})",
                        share == 0 ? "beginning" : "end", h_made, gap, motion.name),
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
