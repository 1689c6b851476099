// SPDX-License-Identifier: BSD-3-Clause
// Frames that a scene does not give, and the ones assumed instead.
#pragma once

#include <string>
#include <vector>

#include <lockstep/scene.h>

namespace lockstep {

/// One line for each body without a position and each marker without a place, except those on particles: "body 'bead'
/// starts at the world's origin".
std::vector<std::string> frames_taken(const Scene&);

}  // namespace lockstep
