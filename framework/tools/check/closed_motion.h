// SPDX-License-Identifier: BSD-3-Clause
// Motions with a closed form, to hold integrators against.
#pragma once

#include <functional>
#include <memory>

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
/// A rod on a hinge released at 1.2 rad: sin(theta/2) = k cn(u)/dn(u), k = sin(0.6), u = t sqrt(m g l/(2 J)). A force
/// without an effect counts the accepted steps, so that there is memory.
LOCKSTEP_API ClosedMotion hinged_pendulum();

}  // namespace lockstep
