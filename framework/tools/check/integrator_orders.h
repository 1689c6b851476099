// SPDX-License-Identifier: BSD-3-Clause
// Runs of an integrator on a motion with a closed form, and the orders that they show.
#pragma once

#include <memory>

#include <lockstep/author/check.h>
#include <lockstep/solvers.h>
#include "framework/tools/check/closed_motion.h"

namespace lockstep {

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
