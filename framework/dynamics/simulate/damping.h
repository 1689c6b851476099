// SPDX-License-Identifier: BSD-3-Clause
// Whether a mechanism has damped modes at all. Internal to the step loop.
#pragma once

#include <lockstep/dynamics.h>

namespace lockstep {

/// Whether anything may take energy out of motions at this state: Baumgarte's terms, a force that dissipates or supplies a
/// power, or one that reports no energy or throws. If nothing does, a mode that decays has one
/// that grows as fast, and no step is short for damped modes.
bool may_damp(Dynamics&, const State&);

}  // namespace lockstep
