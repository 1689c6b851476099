// SPDX-License-Identifier: BSD-3-Clause
// The run of one batch, in lanes or one copy after another. Private to the room.
#pragma once

#include <exception>
#include <vector>

#include <lockstep/author/stepping.h>
#include <lockstep/batch.h>
#include <lockstep/step_loop.h>
#include "framework/tools/batch/batch.h"

namespace lockstep::lanes {

/// What the caller's own functions throw leaves the run as this, which is no failure of a copy.
struct CallerThrew {
  std::exception_ptr what;
};

struct RunTask {
  const CopiesOptions& options;
  const Integrator& method;
  const EmbeddedScheme& scheme;  ///< its coefficients, for the lanes
  const StepLoopOptions& loop;   ///< steps and times
  bool watches;                  ///< a copy near a singular position leaves the lanes
  const std::function<std::unique_ptr<Integrator>()>& make_integrator;
  std::span<const double> times;
  Copies::Output output;  ///< these throw CallerThrew
  Copies::Step step;
  Copies::GoOn go_on;

  /// Of a copy by itself, in joint coordinates.
  Dynamics dynamics_of(System&) const;
  /// Throws StepError if the run is to be broken off.
  void go_on_from(double t) const;
};

/// Takes a state from the near side of the jump of a law to its instant t, in the slots' own coordinates: velocities that
/// jump are projected, as StepLoop does. Throws AssemblyError if positions jump, and what the laws throw.
void pass_jump(Dynamics&, State&, double t);

/// Runs a copy from `state` through the times from the next one on by StepLoop, whose steps end at each of them, or until
/// it fails. The state may violate the constraints by start_limit (StepLoopOptions).
void run_alone(System&, int copy, State state, std::size_t next, double start_limit, const RunTask&, CopyReport&);

}  // namespace lockstep::lanes
