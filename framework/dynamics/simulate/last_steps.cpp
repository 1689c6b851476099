// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/last_steps.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>

namespace lockstep {

namespace {

constexpr double kMostSteps = 1e9;  // a quarter of an hour at a microsecond each

}  // namespace

double LastSteps::mean() const {
  if (n_ == 0) return 0;
  const double from = n_ <= kKept ? t_begin_ : ends_[place(n_)].t;  // the oldest end is where the next step was begun
  const long steps = n_ <= kKept ? n_ : kKept - 1;
  return (ends_[place(n_ - 1)].t - from) / static_cast<double>(steps);
}

long LastSteps::touched(std::uint64_t bit) const {
  return std::count_if(ends_.begin(), ends_.begin() + n(), [&](const End& end) { return (end.touched & bit) != 0; });
}

void LastSteps::check(const RunSoFar& run) const {
  const double left = run.end - run.t, step = mean();
  const bool is_finite = std::isfinite(left);
  const auto rest = [&] {
    return fmt::format("the last {} steps are {:.2g} s long on average, so the rest of the run would take {:.2g} steps",
                       n(), step, left / step);
  };
  const char* const longer = run.adaptive ? "use another tolerance or integrator" : "use a larger step (--step)";
  if (run.max_steps > 0 && run.steps >= run.max_steps && run.t < run.end)
    throw StepError(fmt::format("{}: the run has used its {} steps at t = {:.9g} s{}; allow more (max_steps), or {}",
                                run.method, run.steps, run.t, is_finite && n() > 0 ? "; " + rest() : "", longer),
                    run.t);
  if (!is_finite || n() < kKept || !(left > kMostSteps * step)) return;
  throw StepError(fmt::format("{}: at t = {:.9g} s {}; {}{}", run.method, run.t, rest(), longer,
                              run.adaptive ? ", or find a singular configuration (lockstep check)" : ""),
                  run.t);
}

}  // namespace lockstep
