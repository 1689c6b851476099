// SPDX-License-Identifier: BSD-3-Clause
// Motions with a closed form, to hold integrators against: runs on them, and the orders that these show.
#pragma once

#include <functional>
#include <memory>

#include <lockstep/author/check.h>
#include <lockstep/solvers.h>
#include <lockstep/system.h>

namespace lockstep {

/// A system and where its first slot is at every time when it moves from the system's start.
struct LOCKSTEP_API ClosedMotion {
  const char* name;  ///< "free top"
  double end;        ///< s, of a run that shows an order
  std::unique_ptr<System> system;
  std::function<Pose(double t)> pose;

  /// Distance of the place and the turn that is missing: m + rad.
  double error(const State&) const;
};

/// A body of revolution, thrown: L is constant, and q = exp(t L/J1) q0 exp(t (1 - J3/J1) w3 e3).
LOCKSTEP_API ClosedMotion free_top();
/// A rod on a hinge let go at 1.2 rad: sin(theta/2) = k cn(u)/dn(u), k = sin(0.6), u = t sqrt(m g l/(2 J)). A force
/// without an effect counts the accepted steps, so that there is memory.
LOCKSTEP_API ClosedMotion hinged_pendulum();

/// A run of one object from the start of a motion.
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
  /// The state after n steps of about 0.01 s each.
  const State& go(int n) {
    for (int i = 0; i < n; ++i) step(1e-2), dynamics.accept(state);
    return state;
  }
};

/// The order against the step; of an adaptive method against its mean step, and the error against the tolerance.
void check_order(const IntegratorMaker&, const IntegratorInfo&, const ClosedMotion&, CheckReport&);
/// The dense output of one step from the exact start: its ends, and how its error falls inside.
void check_dense_output(const IntegratorMaker&, const ClosedMotion&, CheckReport&);

}  // namespace lockstep
