// SPDX-License-Identifier: BSD-3-Clause
// Coordinates by the names of their channels.
#pragma once

#include <memory>
#include <string>

#include <lockstep/system.h>
#include "framework/mechanism/lock/coordinate.h"

namespace lockstep {

/// The coordinate or rate that a channel of this name records:
///
///     of a joint, P relative to S      x  vx  x_d  rz  rz_d  angle_z  angle_z_d  omega_x
///     of a body or a marker, world     x  vx  omega_world_x
///     "M.quantity@N", M seen from N    x  vx  omega_x  distance  distance_d
///
/// x also y and z. Throws ModelError if there is none.
LOCKSTEP_API std::shared_ptr<Coordinate> coordinate_named(const System&, const std::string& name);

}  // namespace lockstep
