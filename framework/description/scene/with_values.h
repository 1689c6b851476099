// SPDX-License-Identifier: BSD-3-Clause
// A scene with other values, and a registry with the plugins that it requires.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <lockstep/scene.h>

namespace lockstep {

/// Loads the plugins that the scene requires and the registry lacks, and sets parameters and other plain values. Throws
/// what load_plugin() and set_in_scene() throw.
LOCKSTEP_API Scene with_values(Scene, Registry&, const std::vector<std::pair<std::string, std::string>>& set);

}  // namespace lockstep
