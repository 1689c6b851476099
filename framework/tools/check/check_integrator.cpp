// SPDX-License-Identifier: BSD-3-Clause
// check_integrator: what the step loop relies on: steps, throws, repetitions, steps taken back.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/author/force.h>
#include "framework/foundation/support/thrown.h"
#include "framework/tools/check/closed_motion.h"

namespace lockstep {
namespace {

constexpr double kSame = 1e-12;  // rounding, and between repeated steps: an iteration may begin elsewhere

bool equal(const State& a, const State& b) {
  return a.t == b.t && a.q == b.q && a.v == b.v && a.s == b.s && a.z == b.z && a.modes == b.modes &&
         a.watched == b.watched;
}
double distance(const State& a, const State& b) {
  return std::abs(a.t - b.t) + (a.q - b.q).norm() + (a.v - b.v).norm() + (a.s - b.s).norm();
}

class StepCheck {
 public:
  StepCheck(const IntegratorMaker& make, const IntegratorInfo& info, CheckReport& report)
      : make_(make), info_(info), report_(report) {}

  // Lengths, time, memory, unit quaternions, constraints.
  void steps(const ClosedMotion& motion) {
    Going run(make_, motion);
    const State& state = run.state;
    if (info_.adaptive) {
      const double h = run.method->first_step(run.dynamics, state, 0.1);
      expect(h >= 0 && h <= 0.1, "first", fmt::format("first_step() is {} s where at most 0.1 s were allowed", h),
             "first_step()");
    }
    for (const double h : {1e-2, 1e-3, 1e-3, 1e-5, 2e-2, 5e-3, 5e-3, 5e-3, 5e-3, 5e-3}) {
      const State before = state;
      const StepReport report = run.step(h);
      const std::string here = fmt::format("(asked for {} s at t = {:.6g} s, {})", h, before.t, motion.name);
      expect(report.h > 0 && report.h <= h * (1 + kSame), "length",
             fmt::format("makes a step of {} s {}", report.h, here),
             "the h of step(): one step of at most h, its length in StepReport::h");
      expect(info_.adaptive || std::abs(report.h - h) <= kSame * h, "length",
             fmt::format("makes a step of {} s though it is not adaptive {}", report.h, here),
             "step(), or adaptive in info()");
      expect(std::abs(state.t - before.t - report.h) <= kSame * std::max(1.0, std::abs(state.t)), "time",
             fmt::format("the time went on by {:.9g} s and its report says {:.9g} s {}", state.t - before.t, report.h,
                         here),
             "state.t and StepReport::h in step()");
      expect(state.z == before.z && state.modes == before.modes && state.watched == before.watched, "memory",
             fmt::format("changes what the state remembers (z, or which links are in force) {}", here),
             "step(): z and modes belong to the simulation, which writes them when a step is accepted");
      const bool finite = state.q.allFinite() && state.v.allFinite();
      expect(finite, "finite", fmt::format("the new state is not finite {}", here), "step()");
      if (!finite) return;
      for (int k = 0; k < motion.system->n_slots(); ++k) {
        const double n = state.q.segment<4>(7 * k + 3).norm();
        expect(std::abs(n - 1) <= kSame, "unit",
               fmt::format("a quaternion has length {:.12g} after a step {}", n, here),
               "the end of step(): Dynamics::project, or Dynamics::normalize where nothing is projected");
      }
      const double C = run.dynamics.violation(state), limit = 2 * run.dynamics.options().stabilization.tolerance;
      expect(!(C > limit), "constraints",
             fmt::format("the new state violates the constraints by {:.3g} m, more than {:.3g} m {}", C, limit, here),
             "the end of step(): Dynamics::project(state) where options().stabilization says project", C);
      run.dynamics.accept(run.state);
    }
  }

  // Equal runs: another object, and the same begun anew.
  void repeats(const ClosedMotion& motion) {
    Going run(make_, motion), other(make_, motion);
    const State first = run.go(12), second = other.go(12);
    run.begin(motion.system->start());
    const State& again = run.go(12);
    expect(equal(first, second), "equal",
           fmt::format("two runs of two objects differ by {:.3g} ({})", distance(first, second), motion.name),
           "static or uninitialised variables");
    expect(equal(first, again), "begin",
           fmt::format("begun anew it runs otherwise, by {:.3g} ({})", distance(first, again), motion.name),
           "begin(): it has to forget the history and what a step-size control knows");
  }

  // save() and restore(), on the same object (a step taken back) and on another one (a checkpoint).
  void goes_back(const ClosedMotion& motion) {
    Going run(make_, motion), other(make_, motion);
    const State kept = run.go(7);
    Snapshot snapshot;
    run.method->save(snapshot);
    const State end = run.go(4);
    other.begin(kept);
    const auto again = [&](Going& by, const char* key, const char* what) {
      SnapshotReader in(snapshot);
      by.method->restore(in);
      by.state = kept;
      const double apart = distance(end, by.go(4));
      expect(
          apart <= kSame, key, fmt::format("{} {:.3g} apart ({})", what, apart, motion.name),
          "save() and restore(): all that the next step reads beside the state, the history and the step-size control");
    };
    again(run, "restore", "taken back by restore(), the same steps end");
    again(other, "checkpoint", "another object, begun and restored, goes on");
  }

  // Equations of motion that give NaN: an error, and the state as it was.
  void throws(const ClosedMotion& motion) {
    bool broken = false;
    const Marker& marker = motion.system->marker("hinge.P");
    motion.system->add(function_force("breaks", {&marker}, [&](const Inputs&, WrenchSum& out) {
      if (broken) out.along(0, Vec3::Constant(std::nan("")), Vec3::Zero());
    }));
    motion.system->setup();
    Going run(make_, motion), other(make_, motion);
    const State before = run.go(7);
    broken = true;
    bool thrown = true;
    try {
      run.step(1e-2);
      thrown = false;
    } catch (const Error&) {
    } catch (const std::exception& error) {
      expect(false, "error", fmt::format("throws something that is no lockstep::Error: {}", what_of(error)), "step()");
    }
    expect(thrown, "nan", "makes a step though the equations of motion give no number (NaN)",
           "step(): Dynamics::rate throws then; let it pass, or evaluate where the force acts");
    expect(!thrown || equal(run.state, before), "unchanged", "a step that throws leaves another state behind",
           "step(): work on a copy, and write the state only at the end");
    broken = false;
    run.begin(motion.system->start());
    const State &anew = run.go(5), &fresh = other.go(5);
    expect(equal(anew, fresh), "after",
           fmt::format("begun anew after an error it runs otherwise, by {:.3g}", distance(anew, fresh)),
           "begin(): it has to forget whatever the broken step left");
  }

 private:
  void expect(bool holds, const std::string& key, std::string what, std::string look, double weight = 0) {
    if (!holds) report_.add(key, {std::move(what), std::move(look)}, weight);
  }

  const IntegratorMaker& make_;
  const IntegratorInfo& info_;
  CheckReport& report_;
};

}  // namespace

CheckReport check_integrator(const IntegratorMaker& make, const CheckOptions& options) {
  const std::unique_ptr<Integrator> first = make ? make() : nullptr;
  if (!first) throw ModelError("check_integrator: its maker gives no integrator; give one that does");
  const IntegratorInfo info = first->info();
  CheckReport report(fmt::format("integrator '{}'", info.name), options.seed);
  if (info.name.empty()) report.add("name", {"has no name", "info()"});
  if (info.order < 1) {
    report.add("order", {fmt::format("tells order {}", info.order), "info(): 1 or more"});
    return report;
  }
  const ClosedMotion top = free_top(), pendulum = hinged_pendulum();
  StepCheck check(make, info, report);
  try {
    for (const ClosedMotion* motion : {&top, &pendulum}) {
      check.steps(*motion);
      check.repeats(*motion);
      check.goes_back(*motion);
      check_order(make, info, *motion, report);
      check_dense_output(make, *motion, report);
    }
    check.throws(pendulum);
  } catch (const Error& error) {
    report.add("throws", {fmt::format("gives up on a plain motion: {}", error.what()), "step()"});
  }
  return report;
}

CheckReport check_integrator(const Registry& registry, const std::string& type, const Params& params,
                             const CheckOptions& options) {
  return check_integrator([&] { return registry.integrators.make(type, params, &registry, "integrator"); }, options);
}

}  // namespace lockstep
