// SPDX-License-Identifier: BSD-3-Clause
// Masses and stiffness of a mechanism as sparse matrices in some of its unknown velocities.
#pragma once

#include <string>

#include "framework/tools/rank/stopping_form.h"

namespace lockstep {

SparseMat mass_of(const System&, const Unknowns&);

/// dv of displacements that rest in axes that rotate with a spin, world: Om x dx, and W x dth in slot axes (9.20).
SparseMat carried_by(const Vec3& spin, const System&, const State&);

/// The bodies of a slot: "arm + bob".
std::string bodies_of(const Slot&);

}  // namespace lockstep
