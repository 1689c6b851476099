// SPDX-License-Identifier: BSD-3-Clause
// check_integrator: what the step loop relies on (steps, throws, repetitions, steps taken back), and the orders that runs
// on motions with a closed form show.
#include <lockstep/author/check.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/author/force.h>
#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include "framework/foundation/math/limits.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/check/closed_motion.h"

namespace lockstep {
namespace {

bool equal(const State& a, const State& b) {
  return a.t == b.t && a.q == b.q && a.v == b.v && a.s == b.s && a.z == b.z && a.modes == b.modes &&
         a.watched == b.watched;
}
double distance(const State& a, const State& b) {
  return std::abs(a.t - b.t) + (a.q - b.q).norm() + (a.v - b.v).norm() + (a.s - b.s).norm();
}

// A run of one object from the start of a motion.
struct Going {
  Dynamics dynamics;
  std::unique_ptr<Integrator> method;
  State state;

  Going(const IntegratorMaker& make, const ClosedMotion& motion, const Tolerance& tolerance = tolerance_of(1e-7),
        const DynamicsOptions& options = {})
      : dynamics(*motion.system, std::make_unique<SchurSolver>(), options),
        method(make()),
        state(motion.system->start()) {
    method->set_tolerance(tolerance);
    begin(state);
  }
  void begin(const State& at) { method->begin(dynamics, state = at); }
  StepReport step(double h) { return method->step(dynamics, state, h); }
  // The state after n steps of about 0.01 s each.
  const State& go(int n) {
    for (int i = 0; i < n; ++i) step(1e-2), dynamics.accept(state);
    return state;
  }
};

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
      expect(h >= 0 && h <= 0.1, "first", fmt::format("first_step() is {} s, at most 0.1 s is allowed", h),
             "first_step()");
    }
    for (const double h : {1e-2, 1e-3, 1e-3, 1e-5, 2e-2, 5e-3, 5e-3, 5e-3, 5e-3, 5e-3}) {
      const State before = state;
      const StepReport report = run.step(h);
      const std::string here = fmt::format("(requested: {} s at t = {:.6g} s, {})", h, before.t, motion.name);
      expect(report.h > 0 && report.h <= h * (1 + kRoundOff), "length",
             fmt::format("makes a step of {} s {}", report.h, here),
             "the h of step(): one step of at most h, its length in StepReport::h");
      expect(info_.adaptive || std::abs(report.h - h) <= kRoundOff * h, "length",
             fmt::format("makes a step of {} s although it is not adaptive {}", report.h, here),
             "step(), or adaptive in info()");
      expect(std::abs(state.t - before.t - report.h) <= kRoundOff * std::max(1.0, std::abs(state.t)), "time",
             fmt::format("the time advances by {:.9g} s, but the report gives {:.9g} s {}", state.t - before.t,
                         report.h, here),
             "state.t and StepReport::h in step()");
      expect(state.z == before.z && state.modes == before.modes && state.watched == before.watched, "memory",
             fmt::format("changes the memory of the state (z, or the active joints) {}", here),
             "step(): z and modes belong to the simulation, which writes them when a step is accepted");
      const bool finite = state.q.allFinite() && state.v.allFinite();
      expect(finite, "finite", fmt::format("the new state is not finite {}", here), "step()");
      if (!finite) return;
      for (int k = 0; k < motion.system->n_slots(); ++k) {
        const double n = state.q.segment<4>(7 * k + 3).norm();
        expect(std::abs(n - 1) <= kRoundOff, "unit",
               fmt::format("a quaternion has length {:.12g} after a step {}", n, here),
               "the end of step(): Dynamics::project, or Dynamics::normalize if nothing is projected");
      }
      const double C = run.dynamics.violation(state), limit = 2 * run.dynamics.options().stabilization.tolerance;
      expect(!(C > limit), "constraints",
             fmt::format("the new state violates the constraints by {:.3g} m, more than {:.3g} m {}", C, limit, here),
             "the end of step(): Dynamics::project(state) if options().stabilization is project", C);
      run.dynamics.accept(run.state);
    }
  }

  // Equal runs: another object, and the same after a second begin().
  void repeats(const ClosedMotion& motion) {
    Going run(make_, motion), other(make_, motion);
    const State first = run.go(12), second = other.go(12);
    run.begin(motion.system->start());
    const State& again = run.go(12);
    expect(equal(first, second), "equal",
           fmt::format("runs of two objects differ by {:.3g} ({})", distance(first, second), motion.name),
           "static or uninitialised variables");
    expect(equal(first, again), "begin",
           fmt::format("a run after a second begin() differs by {:.3g} ({})", distance(first, again), motion.name),
           "begin(): it has to reset the history and the step-size control");
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
          apart <= kRoundOff, key, fmt::format("{} {:.3g} apart ({})", what, apart, motion.name),
          "save() and restore(): all that the next step reads in addition to the state: history and step-size control");
    };
    again(run, "restore", "after restore(), the same steps end");
    again(other, "checkpoint", "another object, begun and restored, ends");
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
      expect(false, "error", fmt::format("throws an exception that is not a lockstep::Error: {}", what_of(error)),
             "step()");
    }
    expect(thrown, "nan", "makes a step although the equations of motion give NaN",
           "step(): Dynamics::rate throws then; do not catch it, and evaluate when the force acts");
    expect(!thrown || equal(run.state, before), "unchanged", "a step that throws changes the state",
           "step(): use a temporary state, and write the state only at the end");
    broken = false;
    run.begin(motion.system->start());
    const State &anew = run.go(5), &fresh = other.go(5);
    expect(equal(anew, fresh), "after",
           fmt::format("a run after an error and begin() differs by {:.3g}", distance(anew, fresh)),
           "begin(): it has to reset what the failed step left");
  }

 private:
  void expect(bool holds, const std::string& key, std::string what, std::string look, double weight = 0) {
    if (!holds) report_.add(key, {std::move(what), std::move(look)}, weight);
  }

  const IntegratorMaker& make_;
  const IntegratorInfo& info_;
  CheckReport& report_;
};

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

// The order against the step; of an adaptive method against its mean step, and the error against the tolerance.
void check_order(const IntegratorMaker& make, const IntegratorInfo& info, const ClosedMotion& motion,
                 CheckReport& report) {
  std::vector<double> settings, h, errors;  // of the runs that show an order
  for (int k = 0; k < (info.adaptive ? 9 : 12); ++k) {
    const double setting = info.adaptive ? std::pow(10.0, -3 - k) : std::ldexp(motion.end, -2 - k);
    const Run found = run(make, info, motion, setting);
    if (!found.complete && !info.adaptive) continue;
    if (!found.complete)
      return report.add("adaptive",
                        {fmt::format("does not reach the end of the {} at a tolerance of {:.0e}", motion.name, setting),
                         "step() and StepReport::h_next"});
    if (found.error < kFloor) break;
    if (found.error < kCoarse) settings.push_back(setting), h.push_back(found.h), errors.push_back(found.error);
    if (!info.adaptive && h.size() >= 4 && found.error < 1e-8) break;
  }
  if (h.size() < (info.adaptive ? 3 : 2))
    return report.add("converges", {fmt::format("does not converge to the closed form of the {} at any {}", motion.name,
                                                info.adaptive ? "tolerance" : "step"),
                                    "step()"});
  if (info.adaptive) {
    const double power = slope(settings, errors);
    report.note(fmt::format("error on the {} proportional to the tolerance to the power {:.2f}", motion.name, power));
    if (power < 0.6 || power > 1.7)
      report.add("tolerance",
                 {fmt::format("its error on the {} is proportional to the tolerance to the power {:.2f}, not 1",
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
  report.note(fmt::format("{}, info() declares {}", measured, info.order));
  if (!(order > info.order - kOrderRoom))
    report.add("order",
               {fmt::format("is of {}, but info() declares {}", measured, info.order),
                order < 0.5 ? "step(): the error does not decrease at all"
                            : "the coefficients, the times of the stages, the first steps of a multistep method, and "
                              "order in info()"},
               info.order - order);
}

// The dense output of one step from the exact start: its ends, and how its error falls inside.
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
        return add("dense", "dense() returns a state right after begin() and none after a step",
                   "dense(): always, or never");
      if (std::abs(inside.t - t) > kRoundOff)
        add("dense", "dense() at a time gives a state of another time", "dense(): out.t = t");
      const double error = motion.error(inside), gap = apart(inside, share == 0 ? start : going.state);
      if (share == 0.4 && error > 1e-13) h.push_back(h_made), e.push_back(error);
      if (share != 0.4 && gap > (share == 0 ? 1e-10 : 1e-6 + 10 * motion.error(going.state)))
        add("dense",
            fmt::format("dense() at the {} of a step of {:.3g} s differs from the state by {:.3g} ({})",
                        share == 0 ? "beginning" : "end", h_made, gap, motion.name),
            "dense() at the ends of the step");
    }
  }
  if (h.size() < 3) return;
  const double order = slope(h, e);
  report.note(fmt::format("dense(): its error inside one step decreases with the power {:.2f} of the step on the {}",
                          order, motion.name));
  if (order < 2.6)
    add("dense order",
        fmt::format("the error of dense() decreases only with the power {:.2f} of the step on the {}", order,
                    motion.name),
        "dense(): a polynomial of order 2 at least; a method without one returns false");
}

}  // namespace

CheckReport check_integrator(const IntegratorMaker& make, const CheckOptions& options) {
  const std::unique_ptr<Integrator> first = make ? make() : nullptr;
  if (!first) throw ModelError("check_integrator: the maker returns no integrator; return one");
  const IntegratorInfo info = first->info();
  CheckReport report(fmt::format("integrator '{}'", info.name), options.seed);
  if (info.name.empty()) report.add("name", {"has no name", "info()"});
  if (info.order < 1) {
    report.add("order", {fmt::format("declares order {}", info.order), "info(): 1 or more"});
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
    report.add("throws", {fmt::format("fails on a simple motion: {}", error.what()), "step()"});
  }
  return report;
}

CheckReport check_integrator(const Registry& registry, const std::string& type, const Params& params,
                             const CheckOptions& options) {
  return check_integrator([&] { return registry.integrators.make(type, params, &registry, "integrator"); }, options);
}

}  // namespace lockstep
