// What the step loop relies on: steps, throws, repetitions, steps taken back. The orders are in integrator_orders.cpp.
#include "framework/tools/check/integrator_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/force.h>
#include <lockstep/solvers.h>
#include <lockstep/error.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

constexpr double kStep = 0.01;   // s, of the trials
constexpr double kSame = 1e-12;  // of steps made again: an iteration may begin elsewhere

bool equal(const State& a, const State& b) {
  return a.t == b.t && a.q == b.q && a.v == b.v && a.s == b.s && a.z == b.z && a.modes == b.modes && a.watched == b.watched;
}
double apart(const State& a, const State& b) {
  return std::abs(a.t - b.t) + (a.q - b.q).norm() + (a.v - b.v).norm() + (a.s - b.s).norm();
}

}  // namespace

IntegratorCheck::IntegratorCheck(const IntegratorMaker& make, CheckReport& report)
    : make_(make), report_(report), info_(make()->info()) {}

void IntegratorCheck::run() {
  if (info_.name.empty()) add("name", "has no name", "info()");
  if (info_.order < 1) {
    add("order", fmt::format("tells order {}", info_.order), "info(): 1 or more");
    return;
  }
  ClosedMotion top = free_top(), pendulum = hinged_pendulum();
  try {
    for (ClosedMotion* motion : {&top, &pendulum}) {
      steps(*motion);
      repeats(*motion);
      goes_back(*motion);
      info_.adaptive ? order_of_tolerances(*motion) : order_of_steps(*motion);
      dense_output(*motion);
    }
    throws(pendulum);
  } catch (const Error& error) {
    add("throws", fmt::format("gives up on a plain motion: {}", error.what()), "step()");
  }
}

void IntegratorCheck::add(const std::string& key, std::string what, std::string look, double weight) {
  report_.add(key, {std::move(what), std::move(look)}, weight);
}

std::unique_ptr<Integrator> IntegratorCheck::made() const {
  auto method = make_();
  method->set_tolerance({1e-7, 1e-9});
  return method;
}

void IntegratorCheck::go(Integrator& method, Dynamics& dynamics, State& state, int n, double h) const {
  for (int i = 0; i < n; ++i) {
    method.step(dynamics, state, h);
    dynamics.accept(state);
  }
}

// Lengths, time, memory, unit quaternions, constraints.
void IntegratorCheck::steps(ClosedMotion& motion) {
  Dynamics dynamics(*motion.system, std::make_unique<SchurSolver>());
  const auto method = made();
  State state = motion.system->start();
  method->begin(dynamics, state);
  if (info_.adaptive) {
    const double h = method->first_step(dynamics, state, 0.1);
    if (h < 0 || h > 0.1 || !std::isfinite(h))
      add("first", fmt::format("first_step() is {} s where at most 0.1 s were allowed", h), "first_step()");
  }
  for (const double h : {1e-2, 1e-3, 1e-3, 1e-5, 2e-2, 5e-3, 5e-3, 5e-3, 5e-3, 5e-3}) {
    const State before = state;
    const StepReport report = method->step(dynamics, state, h);
    const std::string here = fmt::format("(asked for {} s at t = {:.6g} s, {})", h, before.t, motion.name);
    if (!(report.h > 0) || report.h > h * (1 + 1e-12))
      add("length", fmt::format("makes a step of {} s {}", report.h, here),
          "the h of step(): one step of at most h, its length in StepReport::h");
    if (!info_.adaptive && std::abs(report.h - h) > 1e-12 * h)
      add("length", fmt::format("makes a step of {} s though it is not adaptive {}", report.h, here),
          "step(), or adaptive in info()");
    if (std::abs(state.t - before.t - report.h) > 1e-12 * std::max(1.0, std::abs(state.t)))
      add("time",
          fmt::format("the time went on by {:.9g} s and its report says {:.9g} s {}", state.t - before.t, report.h,
                      here),
          "state.t and StepReport::h in step()");
    if (state.z != before.z || state.modes != before.modes || state.watched != before.watched)
      add("memory", fmt::format("changes what the state remembers (z, or which links are in force) {}", here),
          "step(): z and modes belong to the simulation, which writes them when a step is accepted");
    if (!state.q.allFinite() || !state.v.allFinite()) {
      add("finite", fmt::format("the new state is not finite {}", here), "step()");
      return;
    }
    for (int k = 0; k < motion.system->n_slots(); ++k)
      if (const double n = state.q.segment<4>(7 * k + 3).norm(); std::abs(n - 1) > 1e-12)
        add("unit", fmt::format("a quaternion has length {:.12g} after a step {}", n, here),
            "the end of step(): Dynamics::project, or Dynamics::normalize where nothing is projected");
    const double C = dynamics.violation(state), limit = 2 * dynamics.options().stabilization.tolerance;
    if (C > limit)
      add("constraints",
          fmt::format("the new state violates the constraints by {:.3g} m, more than {:.3g} m {}", C, limit, here),
          "the end of step(): Dynamics::project(state) where options().stabilization says project", C);
    dynamics.accept(state);
  }
}

// Equal runs: another object, the same begun anew, and after the state was rewound.
void IntegratorCheck::repeats(ClosedMotion& motion) {
  Dynamics dynamics(*motion.system, std::make_unique<SchurSolver>());
  const State start = motion.system->start();
  const auto method = made(), other = made();
  const auto run = [&](Integrator& by) {
    State state = start;
    by.begin(dynamics, state);
    go(by, dynamics, state, 12, kStep);
    return state;
  };
  const State first = run(*method), again = run(*method), second = run(*other);
  if (!equal(first, second))
    add("equal", fmt::format("two runs of two objects differ by {:.3g} ({})", apart(first, second), motion.name),
        "static or uninitialised variables");
  if (!equal(first, again))
    add("begin", fmt::format("begun anew it runs otherwise, by {:.3g} ({})", apart(first, again), motion.name),
        "begin(): it has to forget the history and what a step-size control knows");
}

// save() and restore(), on the same object (a step taken back) and on another one (a checkpoint).
void IntegratorCheck::goes_back(ClosedMotion& motion) {
  Dynamics dynamics(*motion.system, std::make_unique<SchurSolver>());
  const auto method = made(), other = made();
  State state = motion.system->start();
  method->begin(dynamics, state);
  go(*method, dynamics, state, 7, kStep);
  const State kept = state;
  Snapshot snapshot;
  method->save(snapshot);
  go(*method, dynamics, state, 4, kStep);
  const auto from_snapshot = [&](Integrator& by) {
    snapshot.rewind();
    by.restore(snapshot);
    State again = kept;
    go(by, dynamics, again, 4, kStep);
    return again;
  };
  const State back = from_snapshot(*method);
  if (!(apart(state, back) <= kSame))
    add("restore",
        fmt::format("taken back by restore(), the same steps end {:.3g} apart ({})", apart(state, back), motion.name),
        "save() and restore(): all that the next step reads beside the state, the history and the step-size control");
  other->begin(dynamics, kept);
  const State checkpoint = from_snapshot(*other);
  if (!(apart(state, checkpoint) <= kSame))
    add("checkpoint",
        fmt::format("another object, begun and restored, goes on {:.3g} apart ({})", apart(state, checkpoint),
                    motion.name),
        "save() and restore(): all that the next step reads beside the state, the history and the step-size control");
}

// Equations of motion that become no number: an error, and the state as it was.
void IntegratorCheck::throws(ClosedMotion& motion) {
  bool broken = false;
  const Marker& marker = motion.system->marker("hinge.P");
  motion.system->add(function_force("breaks", {&marker}, [&](const Inputs&, WrenchSum& out) {
    if (broken) out.along(0, Vec3::Constant(std::nan("")), Vec3::Zero());
  }));
  motion.system->setup();
  Dynamics dynamics(*motion.system, std::make_unique<SchurSolver>());
  const auto method = made();
  const State start = motion.system->start();
  State state = start;
  method->begin(dynamics, state);
  go(*method, dynamics, state, 7, kStep);
  const State before = state;
  broken = true;
  bool thrown = false;
  try {
    method->step(dynamics, state, kStep);
  } catch (const Error&) {
    thrown = true;
  } catch (const std::exception& error) {
    add("error", fmt::format("throws something that is no lockstep::Error: {}", what_of(error)), "step()");
    thrown = true;
  }
  if (!thrown)
    add("nan", "makes a step though the equations of motion give no number (NaN)",
        "step(): Dynamics::rate throws then; let it pass, or evaluate where the force acts");
  else if (!equal(state, before))
    add("unchanged", "a step that throws leaves another state behind",
        "step(): work on a copy, and write the state only at the end");
  broken = false;
  State anew = start, fresh = start;
  const auto another = made();
  method->begin(dynamics, anew), another->begin(dynamics, fresh);
  go(*method, dynamics, anew, 5, kStep), go(*another, dynamics, fresh, 5, kStep);
  if (!equal(anew, fresh))
    add("after", fmt::format("begun anew after an error it runs otherwise, by {:.3g}", apart(anew, fresh)),
        "begin(): it has to forget whatever the broken step left");
}

}  // namespace lockstep
