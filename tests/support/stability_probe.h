// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Where Baumgarte's stabilisation works, is inaccurate and fails: probes for the test and for the map.

#include <cmath>
#include <functional>
#include <memory>

#include <lockstep/step_loop.h>
#include <lockstep/solvers.h>
#include <lockstep/joints.h>
#include <lockstep/error.h>
#include <lockstep/integrators.h>

namespace lockstep::stability {

using Method = std::function<std::unique_ptr<Integrator>()>;

/// (2.16): the largest gain times step at critical damping.
struct Limit {
  const char* method;
  Method make;
  double gain_h;
};
inline const Limit kLimits[] = {
    {"rk4", [] { return std::make_unique<Rk4>(); }, 2.785},
    {"semi_implicit_euler", [] { return std::make_unique<SemiImplicitEuler>(); }, 2.0 * std::sqrt(2.0) - 2.0}};

inline DynamicsOptions baumgarte(double gain) {
  DynamicsOptions options{.formulation = Formulation::omega, .stabilization = {}};  // of rows and their drift
  options.stabilization.kind = Stabilization::Kind::baumgarte;
  options.stabilization.alpha = options.stabilization.beta = gain;
  return options;
}

/// A bead beside its straight wire: rows are constant, so that (2.15) is the method's test equation itself. Returns
/// |C(end)| / |C(start)|.
inline double violation_ratio(const Limit& limit, double gain_h, int n_steps) {
  constexpr double h = 0.01, kOff = 1e-3;  // s, m
  System sys;
  Body& bead = sys.add_body("bead", shapes::sphere(1.0, 0.1));
  Marker& P = sys.add_marker("P", bead);
  Marker& S = sys.add_marker("S", sys.ground(), {Vec3(kOff, 0, 0), {}});
  sys.add<PointOnLine>("wire", P, S);
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), baumgarte(gain_h / h));
  StepLoop run(dynamics, limit.make(), {.step = h, .tolerance = {}, .start_limit = 1.0});
  for (int i = 0; i < n_steps; ++i) run.step();
  return dynamics.violation(run.state()) / kOff;
}

/// A rod that swings from the horizontal about a hinge at its end.
struct Pendulum {
  System sys{System::Options{Vec3(0, -9.81, 0)}};
  Pendulum() {
    Body& bar = sys.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    sys.add<Revolute>("hinge", bar, sys.ground(), pose_at({0, 0, 0}));
  }
};
inline constexpr double kSwing = 2.0;  // s

/// Where the middle of the rod is after kSwing: projected, at a tight tolerance.
inline Vec3 swung() {
  Pendulum p;
  Dynamics dynamics(p.sys, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-12, 1e-14}});
  run.run_until(kSwing);
  return run.state().slot_pose(0).x;
}

enum Verdict { kWorks, kInaccurate, kFails };
inline constexpr double kAccurate = 0.01;  // m, of a rod 1 m long: the largest error that "works"
inline constexpr double kLost = 1.0;       // m: the rod is somewhere else altogether

/// The pendulum, begun 1e-6 m off its hinge, by a method at step h with gains gain_h / h.
inline Verdict swing(const Limit& limit, double gain_h, double h, const Vec3& truth) {
  Pendulum p;
  const int n_steps = static_cast<int>(std::lround(kSwing / h));
  Dynamics dynamics(p.sys, std::make_unique<SchurSolver>(), baumgarte(gain_h / h));
  StepLoop run(dynamics, limit.make(), {.step = kSwing / n_steps, .tolerance = {}, .start_limit = 1e-3});
  State start = p.sys.start();
  start.q[1] += 1e-6;
  run.set_state(start);
  try {
    run.run_until(kSwing);
  } catch (const Error&) {
    return kFails;
  }
  const double error = (run.state().q.head<3>() - truth).norm(), violation = dynamics.violation(run.state());
  if (!std::isfinite(error) || !(violation < kLost) || error > kLost) return kFails;
  return error < kAccurate && violation < kAccurate ? kWorks : kInaccurate;
}

}  // namespace lockstep::stability
