// SPDX-License-Identifier: BSD-3-Clause
// Why a run stopped. What a method of fixed steps left behind says little about it, so its motion is computed again by
// dopri5, which chooses its steps: it meets the same obstacle, or shows the fastest rate that the step had to follow.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/solvers.h>
#include <lockstep/system.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/foundation/support/finding_kinds.h"
#include "framework/mechanism/system/diagnose.h"
#include "framework/tools/rank/cause.h"

namespace lockstep {
namespace {

/// Size of the largest eigenvalue of the equations of motion, 1/s, but at least the fastest rotation: by powers of
/// differences of their rates. Oscillations repeat after two powers, so it is the mean growth of an even number, with
/// positions as velocities by the mean before.
double fastest_rate(Dynamics& dynamics, const State& at) {
  const State slots = dynamics.in_slots(at);
  double turns = 0;
  for (const Motion& O : dynamics.inputs(slots).motions) turns = std::max(turns, O.w.norm());
  constexpr int kPowers = 20;
  const double d = kNearlyDependent * kNearlyDependent * dynamics.system().length();
  StateRate r0, r1;
  dynamics.rates(at, r0);
  VecX q = VecX::Zero(at.v.size()), v = VecX::LinSpaced(at.v.size(), 1, 2);
  double rate = 1;
  for (int mean = 0; mean < 3; ++mean) {
    double growth = 0;
    for (int k = 0; k < kPowers; ++k) {
      const double size = std::sqrt(q.squaredNorm() * rate * rate + v.squaredNorm());
      if (!(size > 0) || !std::isfinite(size)) return std::max(rate, turns);
      q /= size, v /= size;
      State off = at;
      advance_state(off, d, q);
      off.v += d * v;
      dynamics.rates(off, r1);
      q = v, v = (r1.v - r0.v) / d;
      growth += std::log(std::sqrt(q.squaredNorm() * rate * rate + v.squaredNorm())) / kPowers;
    }
    rate = std::exp(growth);
  }
  return std::max(rate, turns);
}

/// States of a motion, evenly spread over its steps, which are short where it is fast.
class Spread {
 public:
  void add(const State& state) {
    if (n_++ % stride_ != 0) return;
    states_.push_back(state);
    if (states_.size() < kMost) return;
    for (std::size_t i = 1; 2 * i < states_.size(); ++i) states_[i] = states_[2 * i];
    states_.resize(states_.size() / 2), stride_ *= 2;
  }
  const std::vector<State>& states() const { return states_; }

 private:
  static constexpr std::size_t kMost = 16;
  std::vector<State> states_;
  std::size_t n_ = 0, stride_ = 1;
};

/// The motion from `start` to `end`, s, within so many steps: why it ends before, or why `step` is too long for it.
Cause found_by_small_steps(Dynamics& dynamics, State start, double end, double step, long most_steps) {
  Spread motion;
  dynamics.to_formulation(start);
  motion.add(start);
  try {
    const Registry methods = builtin_registry();
    const std::unique_ptr<Integrator> method = make_integrator({.type = "dopri5"}, methods, "integrator");
    method->begin(dynamics, start);
    double h = start.t < end ? method->first_step(dynamics, start, end - start.t) : 0;
    for (long n = 0; n < most_steps && start.t < end; ++n) {
      h = method->step(dynamics, start, std::min(h, end - start.t)).h_next;
      dynamics.accept(start);
      motion.add(start);
    }
  } catch (const Error&) {
    if (Cause cause = cause_of_stop(dynamics, start); cause.found()) return cause;
  }
  double rate = 0, t = 0;
  for (const State& at : motion.states()) try {
      if (const double there = fastest_rate(dynamics, at); there > (1 + kNearlyDependent) * rate) rate = there, t = at.t;
    } catch (const Error&) {  // of a law there, as may be what stops the run
    }
  // rad in a step: explicit methods are unstable beyond 1 to 3
  if (!(rate * step > 1)) return {};
  return {fmt::format("the step of {:.3g} s is too long: at t = {:.4g} s the fastest motion has a rate of {:.3g} 1/s",
                      step, t, rate),
          fmt::format("take a step of {:.2g} to {:.2g} s, or a method that chooses its steps", 0.1 / rate, 1 / rate)};
}

// Why a run that began at `started` stopped.
Cause cause_of_run(System& system, StepLoop& run, State started, double step) {
  Dynamics& dynamics = run.dynamics();
  const State at = run.state();
  const std::vector<Finding>& findings = run.report().findings;
  const auto has = [&](const FindingKind& kind) { return std::ranges::find(findings, kind.code, &Finding::code); };
  if (!run.integrator().info().adaptive) {
    if (const auto cut = has(finding::long_steps); cut != findings.end()) step = cut->limit;
    // The motion is not repeated if a host, an event or a stop may have changed it.
    const bool changed =
        !system.control_inputs().empty() || !run.event_courses().empty() ||
        std::ranges::any_of(system.links(), [](const auto& link) { return link->unilateral() != nullptr; });
    dynamics.to_slots(started);
    Dynamics own(system, std::make_unique<SparseSolver>(), dynamics.options());  // that of the run may go on
    if (Cause cause =
            found_by_small_steps(own, started, changed ? started.t : at.t + 2 * step, step, run.report().steps + 1000);
        cause.found())
      return cause;
  }
  if (has(finding::violated_in_run) != findings.end() &&
      dynamics.options().stabilization.kind != Stabilization::Kind::project)
    return {"the constraints drift until no step is possible", "project after each step (\"stabilization\": \"project\")"};
  return cause_of_stop(dynamics, at);
}

}  // namespace

void rethrow_of_run(System& system, StepLoop& run, const State& started, double step, const Error& error,
                    const std::string& lines) {
  using Kind = Error::Kind;
  constexpr Kind kOfMechanism[] = {Kind::assembly, Kind::solve, Kind::step, Kind::non_finite};
  Cause cause;
  if (std::ranges::count(kOfMechanism, error.kind()) > 0) cause = cause_of_run(system, run, started, step);
  const std::string first = tests_first(system);
  if (!cause.found() && error.kind() == Kind::step && !first.empty() && error.advice.find(first) == error.advice.npos)
    cause = {error.fact(), first + error.advice};
  rethrow_with(cause, error, lines);
}

}  // namespace lockstep
