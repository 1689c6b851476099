// SPDX-License-Identifier: BSD-3-Clause
// The integrators that come with lockstep.
#pragma once

#include <lockstep/detail/export.h>

namespace lockstep {

class Registry;

/// Registers semi_implicit_euler, rk4, dopri5, dop853, generalized_alpha, radau5, rattle2 and rattle4.
LOCKSTEP_API void register_integrators(Registry&);

}  // namespace lockstep
