// SPDX-License-Identifier: BSD-3-Clause
// Changes to inputs, the same for the same seed.
#pragma once

#include <random>
#include <string>

namespace lockstep::fuzz {

/// The text with some bytes changed, parts repeated, moved, cut or replaced by words that mean something.
std::string mutated(std::string text, std::mt19937_64& bits);

/// A scene with values, keys, names and whole things changed, so that it is still JSON; any other text by mutated().
std::string mutated_scene(const std::string& text, std::mt19937_64& bits);

}  // namespace lockstep::fuzz
