#include "framework/dynamics/simulate/pace.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/step_rules.h"

namespace lockstep {

namespace {

constexpr double kLongRun = 1e7;  // steps left of which the run warns

}  // namespace

std::string Pace::watch(const PacedRun& run, double t, long n) {
  if (run.max_steps > 0 && n >= run.max_steps && t < run.end)
    throw StepError(
        fmt::format(
            "{}: the run has made its {} steps and stands at t = {:.9g} s; allow more (max_steps), or {}", run.method,
            n, t,
            run.adaptive ? "make them longer (a wider tolerance, another integrator)" : "take a larger step (--step)"),
        t);
  if (!std::isfinite(run.end)) return {};
  const double left = run.end - t;
  if (!(run.advised > 0 && left > kMostSteps * run.advised))
    slow_from = n;
  else if (slow_from < 0)
    slow_from = n - 1;
  if (n - slow_from > kSlow)
    throw StepError(
        fmt::format(
            "{}: at t = {:.9g} s it advises steps of {:.3g} s, by which the rest of the run would take {:.2g} of "
            "them{}",
            run.method, t, run.advised, left / run.advised,
            !run.adaptive ? "; take a larger step (--step)"
                          : "; use another method (--integrator), a wider tolerance, or look for a singular position "
                            "(lockstep check)"),
        t);
  const long n_steps = n - from_n;
  if (n_steps < kPaced) return {};
  const double pace = (t - from) / static_cast<double>(n_steps);
  if (left > 1.001 * kMostSteps * pace)  // of the steps made, however long those advised are; but for rounding
    throw StepError(fmt::format("{}: its last {} steps, up to t = {:.9g} s, were of {:.2g} s on average, by which the "
                                "rest of the run would take {:.2g} of them",
                                run.method, n_steps, t, pace, left / pace),
                    t);
  from = t, from_n = n;
  if (warned || left <= kLongRun * pace) return {};
  warned = true;
  return fmt::format(
      "the run is slow: by the last {} steps, of {:.2g} s on average up to t = {:.6g} s, the rest of it will "
      "take {:.2g} steps",
      kPaced, pace, t, left / pace);
}

}  // namespace lockstep
