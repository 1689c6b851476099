// check_force: holds what a force says about itself - power, energies, tangent - against what it does to the bodies.
#pragma once

#include "framework/tools/check/report.h"
#include "framework/mechanism/params/params.h"
#include "framework/description/registry/registry.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {

/// At random states about the start:
///
///   power f.v = -dV/dt - dissipation() + supply(),   dissipation() >= 0,   K = -df/d(x, turn) and D = -df/d(v, w) of
///   tangent() (9.13)
///
/// by differences whose own error estimate is the tolerance; and: numbers finite, the same when asked again and for a
/// quaternion of the other sign; no body pushed on which markers() has none; memory and full turns about z of S; jumps
/// in time outside of breakpoints(). A force that reads reactions gets drawn ones, and react(), friction_loss() and
/// react_tangent() are looked at with apply() and the others. The force has to be one of the system's. Throws
/// ModelError if not, and what setup() throws.
LOCKSTEP_API CheckReport check_force(System&, const Force&, const CheckOptions& options = {});

/// The same for a registered type, which is made from `params` in a small system of its own: between moving bodies,
/// with either side on the ground, with markers that move by laws. Throws what the maker throws;
/// what it refuses in the later ones is noted.
LOCKSTEP_API CheckReport check_force(const Registry&, const std::string& type, const Params& params = {},
                                     const CheckOptions& options = {});

}  // namespace lockstep
