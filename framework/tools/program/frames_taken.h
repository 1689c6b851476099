// SPDX-License-Identifier: BSD-3-Clause
// Frames that a scene leaves out, and which are taken instead.
#pragma once

#include <string>
#include <vector>

#include <lockstep/scene.h>

namespace lockstep {

/// One line for each body without a position and each marker without a place, but those on particles: "body 'bead' starts at the world's
/// origin".
std::vector<std::string> frames_taken(const Scene&);

}  // namespace lockstep
