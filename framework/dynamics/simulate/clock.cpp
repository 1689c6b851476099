// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/consistency.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/simulate/step_rules.h"
#include "framework/foundation/math/limits.h"

namespace lockstep {

void Clock::start(double t) {
  t_start_ = t;
  breakpoints_to_ = -kNever;
  last_.begin(t);
  last_output_ = -kNever;
  next_output_ = 0;
  while (output_time(next_output_) < t) ++next_output_;
}

double Clock::span() const { return std::isfinite(t_end_) ? t_end_ - t_start_ : 0; }

double Clock::same_instant(double t) const { return kRoundOff * std::max(std::abs(t), span()); }

double Clock::horizon(double t) const {
  const double left = std::isfinite(t_end_) ? t_end_ - t : 1.0;
  return options_.step > 0 ? std::min(left, options_.step) : left;
}

void Clock::begin(double t, double guess) {
  set_anchor(t);
  advised_ = info_.adaptive ? guess : options_.step;
  if (info_.adaptive && guess > 0)
    advised_ = std::max(guess, least_step(t, span()));  // only a step that was tried is too short
  if (!(advised_ > 0)) advised_ = options_.step > 0 ? options_.step : 1e-3;
}

// Where a law jumps at t, the step ends slightly before t, so that no stage sees the right-hand side; the rest is
// crossed with the rates there (StepLoop::cross_jump).
Clock::Target Clock::next_target(double t, double limit, double event, double largest, bool interpolates) {
  refresh_breakpoints(t, limit, largest);
  while (next_breakpoint_ < breakpoints_.size() && breakpoints_[next_breakpoint_] <= t) ++next_breakpoint_;
  const double jump = next_breakpoint_ < breakpoints_.size() ? breakpoints_[next_breakpoint_] : kNever;
  if (jump > event && jump <= std::min(limit, event + same_instant(event))) event = jump;  // they are one change
  double next = std::min(limit, event);
  if (!interpolates && next_output() > t) next = std::min(next, next_output());
  if (jump > next || jump == kNever) return {next, next, false};
  const double before = before_jump(jump, std::max(jump - t, span()));
  return {jump, jump - before > t ? jump - before : jump, true};
}

double Clock::step_towards(double t, const Target& target, double largest) const {
  const double left = target.reach - t;
  if (!info_.adaptive) {
    const double size = largest > 0 ? largest : options_.step;
    const double end = largest > 0 ? t + size : anchor_ + static_cast<double>(n_from_anchor_ + 1) * size;
    return end >= target.reach - kNegligible * size ? left : end - t;
  }
  double h = advised_ > 0 ? advised_ : kNever;
  if (options_.step > 0) h = std::min(h, options_.step);
  if (largest > 0) h = std::min(h, largest);
  if (h < least_step(t, span()))
    throw StepError(
        fmt::format(
            "{}: the step shrank to {:.3g} s at t = {:.9g} s, which is round-off of a run of {:.3g} s; use another "
            "method (--integrator) or tolerance, or find a singular configuration (lockstep check)",
            info_.name, h, t, span()),
        t);
  return step_within(left, h, same_instant(t));
}

void Clock::count_step(double asked, const StepReport& report) {
  ++n_from_anchor_;
  if (info_.adaptive) advised_ = advised_after(advised_, asked, report.h, report.h_next);
}

void Clock::refresh_breakpoints(double t, double limit, double largest) {
  const double size = std::max({advised_, options_.step, largest});
  const bool open = !std::isfinite(limit);  // single steps: no end is known
  if (breakpoints_to_ >= (open ? t + 2 * size : limit)) return;
  const double far = open ? t + 256 * size : limit;
  passes::breakpoints(system_, t, std::nextafter(far, kNever), breakpoints_);  // including one at the very end
  breakpoints_to_ = far;
  next_breakpoint_ = 0;
}

double Clock::output_time(long k) const {
  const std::vector<double>& times = options_.output_times;
  if (!times.empty()) return k < static_cast<long>(times.size()) ? times[k] : kNever;
  if (!(options_.output > 0)) return kNever;
  const double t = t_start_ + static_cast<double>(k) * options_.output;
  return std::abs(t - t_end_) < kNegligible * options_.output ? t_end_ : t;
}

bool Clock::output_due(double t) const {
  const bool at_times = !options_.output_times.empty();
  return (!at_times && (options_.output == 0 || t == t_start_)) || next_output() == t;
}

double Clock::shortest_output() const {
  const std::vector<double>& times = options_.output_times;
  if (times.empty()) return options_.output > 0 ? options_.output : kNever;
  double shortest = kNever;
  for (std::size_t k = 1; k < times.size(); ++k) shortest = std::min(shortest, times[k] - times[k - 1]);
  return shortest;
}

bool Clock::end_due(double t) const {
  return options_.output_times.empty() && options_.output > 0 && last_output_ != t;
}

// The known jumps are kept: computed again from here they might differ in the last bit.
void Clock::save(Snapshot& out) const {
  for (const double x : {t_start_, t_end_, advised_, anchor_, last_output_, breakpoints_to_}) out.put(x);
  for (const long n : {n_from_anchor_, next_output_}) out.put(static_cast<double>(n));
  out.put_all(
      std::vector<double>(breakpoints_.begin() + static_cast<std::ptrdiff_t>(next_breakpoint_), breakpoints_.end()));
}

void Clock::load(SnapshotReader& in) {
  for (double* x : {&t_start_, &t_end_, &advised_, &anchor_, &last_output_, &breakpoints_to_}) *x = in.get();
  for (long* n : {&n_from_anchor_, &next_output_}) *n = in.get_count();
  if (next_output_ < 0)
    throw ModelError("the saved number of outputs is negative: the checkpoint is damaged; use an older one");
  in.get_all(breakpoints_), next_breakpoint_ = 0;
}

}  // namespace lockstep
