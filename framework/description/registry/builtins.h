// SPDX-License-Identifier: BSD-3-Clause
// Which plugins are parts of the library itself.
#pragma once

#include <string_view>

namespace lockstep {

/// Whether the library loads the plugin of this name for its own laws or integrators (LOCKSTEP_BUILTINS=OFF).
bool is_part_of_library(std::string_view plugin);

}  // namespace lockstep
