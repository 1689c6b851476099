// check_lock: holds what a link says about itself against differences of its own constraint.
#pragma once

#include "framework/tools/check/report.h"
#include "framework/mechanism/lock/lock.h"
#include "framework/mechanism/params/params.h"
#include "framework/description/registry/registry.h"
#include "framework/mechanism/system/system.h"

namespace lockstep {

/// At random states about the start, off the constraints as well:
///
///   each entry of Jh against dC/d(x, turn),   Ct against dC/dt of the held pose,   Qhat against -Cdd of a motion
///   without accelerations (4.14),   tangent() against d(Jh^T lambda)/d(x, turn) (9.4)
///
/// by differences of order 8 whose own error estimate is the tolerance (Qhat: second differences, some 1e-8); and:
/// rows, names and kinds; every number written and none beside them; numbers finite, the same when asked again, the
/// same for a quaternion of the other sign; slots() complete; groups; memory and full turns about z of S; jumps in time
/// outside of breakpoints(). Rows in space only, not gather_plane(). The link has to be one of the system's. Throws
/// ModelError if not, and what setup() throws.
LOCKSTEP_API CheckReport check_lock(System&, const Lock&, const CheckOptions& options = {});

/// The same for a registered type, which is made from `params` between bodies of a small system of its own: both
/// moving, either side on the ground, markers that move by laws. Throws what the maker
/// throws; what it refuses in the later ones is noted.
LOCKSTEP_API CheckReport check_lock(const Registry&, const std::string& type, const Params& params = {},
                                    const CheckOptions& options = {});

}  // namespace lockstep
