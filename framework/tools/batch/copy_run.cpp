// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/batch/copy_run.h"

#include <utility>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include "framework/dynamics/simulate/consistency.h"
#include "framework/dynamics/simulate/last_steps.h"

namespace lockstep::lanes {

void pass_jump(Dynamics& dynamics, State& state, double t) {
  const double limit = StepLoopOptions().start_limit;
  dynamics.to_slots(state);
  const PositionJump jump(dynamics, state);
  StateRate rate = sized_like(state);
  cross_rest(dynamics, state, t, rate);
  if (const auto refusal = jump.refusal(dynamics, state, limit)) throw AssemblyError(*refusal);
  make_consistent(dynamics, state, "the jump of a law", limit);
}

namespace {

/// Counts the steps of a copy that runs alone, and hands them on. What is thrown there leaves the run as it is.
class Follower final : public Observer {
 public:
  Follower(int copy, Dynamics& dynamics, const RunTask& task, CopyReport& report)
      : copy_(copy), dynamics_(dynamics), task_(task), report_(report) {
    last_.begin(report.t);
  }
  void step(const Sample& sample) override {
    ++report_.steps, report_.rejected += sample.report.rejected;
    report_.t = sample.state.t, report_.unmet.count(sample.report, report_.t);
    last_.add(report_.t);
    tell(sample.state, false);
    if (report_.t < task_.times.back())
      guarded([&] {
        task_.go_on_from(report_.t);
        last_.check({task_.options.integrator, task_.scheme.error != nullptr, report_.t, task_.times.back(),
                     report_.steps, task_.loop.max_steps});
      });
  }
  void jumped(const Sample& sample) override { tell(sample.state, true); }
  bool threw() const { return threw_ != nullptr; }
  void rethrow() const {
    if (threw_) std::rethrow_exception(threw_);
  }

 private:
  void tell(const State& state, bool jumped) {
    if (task_.step) guarded([&] { task_.step(copy_, dynamics_.in_slots(state), jumped); });
  }
  template <class Act>
  void guarded(Act&& act) try {
    if (!threw_) act();
  } catch (...) {
    threw_ = std::current_exception();
  }

  int copy_;
  Dynamics& dynamics_;
  const RunTask& task_;
  CopyReport& report_;
  LastSteps last_;
  std::exception_ptr threw_;
};

}  // namespace

Dynamics RunTask::dynamics_of(System& system) const {
  return Dynamics(system, std::make_unique<SchurSolver>(), {Formulation::joint, options.stabilization});
}

void RunTask::go_on_from(double t) const {
  if (go_on && !go_on(t)) throw StepError("stopped by the caller", t);
}

void run_alone(System& system, int copy, State state, std::size_t next, double start_limit, const RunTask& task,
               CopyReport& report) try {
  report.alone = true, report.t = state.t;
  Dynamics dynamics = task.dynamics_of(system);
  StepLoop loop(dynamics, task.make_integrator(),
                {.step = task.loop.step, .tolerance = task.loop.tolerance, .start_limit = start_limit});
  Follower follower(copy, dynamics, task, report);
  loop.add_observer(follower);
  loop.set_state(std::move(state));
  loop.progress = [&](const State&) { return !follower.threw(); };
  task.go_on_from(report.t);
  for (; next < task.times.size(); ++next) {
    try {
      loop.run_until(task.times[next]);
    } catch (const Error&) {
      follower.rethrow();  // what the caller threw is the cause
      throw;
    }
    follower.rethrow();
    task.output(copy, next, dynamics.in_slots(loop.state()));
  }
} catch (const Error& error) {
  report.finished = false;
  report.error = error.what();
}

}  // namespace lockstep::lanes
