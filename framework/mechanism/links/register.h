// SPDX-License-Identifier: BSD-3-Clause
// Registers the built-in joints.
#pragma once

#include <lockstep/detail/export.h>

namespace lockstep {
class Registry;
LOCKSTEP_API void register_links(Registry&);
}  // namespace lockstep
