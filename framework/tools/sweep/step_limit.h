// SPDX-License-Identifier: BSD-3-Clause
// The largest fixed step of a method by linear theory: a scene's small motions about its start.
#pragma once

#include <lockstep/scene.h>

namespace lockstep {

/// Accelerations of a mechanism near a state: dx'' = A dx + B dx', of all rigid groups, in the directions of their
/// velocities; with Baumgarte stabilisation if it is on, so that the roots of drift are among the motions.
struct SmallMotions {
  MatX A, B;
};

/// By central differences at the assembled start. Throws as a run does.
LOCKSTEP_API SmallMotions small_motions(const Scene&, const Registry&);

/// The smallest step in [low, high], s, beyond which the method is unstable for stable small motions; infinite if there
/// is none, NaN if the method has no known theory. rk4, semi_implicit_euler, rattle2, and dopri5 with fixed steps have
/// one.
LOCKSTEP_API double step_limit(const MethodSpec&, const SmallMotions&, double low, double high);

}  // namespace lockstep
