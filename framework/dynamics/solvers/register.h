// SPDX-License-Identifier: BSD-3-Clause
// Registers the solvers of this room.
#pragma once

#include <lockstep/detail/export.h>

namespace lockstep {

class Registry;

LOCKSTEP_API void register_solvers(Registry&);

}  // namespace lockstep
