// SPDX-License-Identifier: BSD-3-Clause
// Runs a scene with things that do not come with lockstep: plugins of the test's own choice.
#pragma once

#include <lockstep/author/registry.h>
#include "tests/support/run_scene.h"

namespace lockstep {

/// run_scene() with what this registry holds.
SceneRun run_with_registry(const Registry& registry, const std::string& path,
                           const std::function<void(RunSettings&)>& change = {},
                           const std::function<void(Scene&)>& describe = {});

}  // namespace lockstep
