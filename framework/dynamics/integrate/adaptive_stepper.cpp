// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/stepping.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <lockstep/error.h>
#include "framework/dynamics/integrate/culprit.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

constexpr int kMostFailures = 8;  // attempts that cannot be evaluated before the error is rethrown

// How far to look for what makes steps short, s.
double a_while_after(double t) { return 1e-9 * std::max(1.0, std::abs(t)); }

// Why steps from `start` become short, in words: what changes most there, how the last attempt failed, and advice.
// `landed`: the end of the last attempt that had one.
std::string reason(Dynamics& dynamics, const State& start, const State& landed, const std::string& failure,
                   const std::string& advice) {
  std::string words = who_varies(dynamics, start, a_while_after(start.t));
  if (!words.empty()) return words;
  if (failure.empty()) return advice;
  const std::string row = most_violated(dynamics, landed);
  return tests_first(dynamics.system()) +
         "two laws or joints may contradict each other, or the mechanism is locked: " + advice +
         "; the last attempt failed: " + failure + (row.empty() ? "" : " (worst: " + row + ")");
}

}  // namespace

AdaptiveStepper::AdaptiveStepper(int order, std::unique_ptr<StepControl> control)
    : order_(order), control_(std::move(control)) {}

AdaptiveStepper::~AdaptiveStepper() = default;

void AdaptiveStepper::begin(Dynamics& dynamics, const State& state) {
  dynamics.system().check_size(state);
  start_ = end_ = landed_ = state;
  norm_.set_states(dynamics.system().n_error_controlled_states());
  norm_.scale(state, 1.0);
  if (control_) control_->begin();
}

StepReport AdaptiveStepper::step(Dynamics& dynamics, State& state, double h) {
  dynamics.system().check_size(state);
  StepReport report;
  const double asked = h;
  int failures = 0;
  bool rejected = false;
  std::string failure;                              // of the last attempt, in words
  const auto longer_fails = [&]() -> std::string {  // short steps leave no failure, longer ones do
    for (const double longer : {1.0, 1e3, 1e6}) {
      try {
        attempt(dynamics, longer * a_while_after(start_.t));
        copy_motion(end_, landed_);
        if (const ProjectReport end = project_end(dynamics, landed_); !end.converged)
          return fmt::format("its end violates the constraints by {:.2g} m and cannot be projected", end.after);
      } catch (const Error& error) {
        return error.what();
      }
    }
    return {};
  };
  copy_motion(state, start_);
  if (state.z.size() > 0) start_.z = end_.z = landed_.z = state.z;
  h = start_step(dynamics, h);
  for (;; ++report.rejected) {
    double next = 0.5 * h;
    const auto failed = [&] { return fixed() || ++failures > kMostFailures || step_stalled(state.t, next); };
    try {
      const Attempt made = attempt(dynamics, h);
      failure.clear();
      if (made.accepted && land(dynamics, h, report)) {
        report.h = h;
        report.error = made.error;
        if (control_) report.h_next = h * control_->accept(h, made.error, made.iterations, rejected);
        finish_step(dynamics, report);
        take_motion(landed_, state);
        return report;
      }
      if (made.accepted)
        failure =
            fmt::format("its end violates the constraints by {:.2g} m and cannot be projected", report.violation_after);
      rejected = true;
      if (made.next > 0)
        next = made.next;
      else if (control_ && !(made.error <= 1))
        next = h * control_->reject(made.error, made.iterations);
    } catch (const Error& error) {
      const bool of_state = error.kind() == Error::Kind::non_finite || error.kind() == Error::Kind::solve;
      if (!of_state || failed()) throw;
      rejected = true, failure = error.what();
    }
    h = next;
    if (step_vanished(state.t, h, asked)) {
      if (failure.empty()) failure = longer_fails();
      throw StepError(
          fmt::format("{}: the step shrank to {:.3g} s at t = {:.9g} s after {} rejected steps; {}", info().name, h,
                      state.t, report.rejected + 1, reason(dynamics, start_, landed_, failure, advice())),
          state.t);
    }
  }
}

bool AdaptiveStepper::land(Dynamics& dynamics, double h, StepReport& report) {
  copy_motion(end_, landed_);
  const ProjectReport landed = project_end(dynamics, landed_);
  report.violation = landed.before, report.violation_after = landed.after;
  const bool near = end_is_near(dynamics, landed, fixed());
  if (!near && fixed()) throw end_not_projected(dynamics, landed_, landed, info().name, start_.t, h);
  return near;
}

ProjectReport AdaptiveStepper::project_end(Dynamics& dynamics, State& y) { return lockstep::project_end(dynamics, y); }

std::string AdaptiveStepper::advice() const {
  return "use another method (--integrator) or tolerance, or find a singular configuration (lockstep check)";
}

void AdaptiveStepper::newton_failed(double h, const char* advice) const {
  throw StepError(
      fmt::format("{}: Newton's method did not converge in the step of {:.6g} s from t = {:.9g} s; take a smaller step "
                  "(--step), {}",
                  info().name, h, start_.t, advice),
      start_.t);
}

double AdaptiveStepper::first_step(Dynamics& dynamics, const State& state, double largest) {
  if (fixed()) return 0;
  size_like(state, guess0_), size_like(state, guess1_);
  return guess_first_step(dynamics, state, order_, largest, norm_, guess0_, guess1_, end_);
}

void AdaptiveStepper::save(Snapshot& out) const {
  if (control_) control_->save(out);
}

void AdaptiveStepper::restore(SnapshotReader& in) {
  if (control_) control_->restore(in);
}

}  // namespace lockstep
