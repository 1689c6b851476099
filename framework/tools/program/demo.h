// SPDX-License-Identifier: BSD-3-Clause
// The scene that `lockstep demo` shows.
#pragma once

#include <string_view>

namespace lockstep {

/// Text of a scene file; the program holds it.
std::string_view demo_scene();

}  // namespace lockstep
