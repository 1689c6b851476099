// SPDX-License-Identifier: BSD-3-Clause
// A small motion of a mechanism in words.
#pragma once

#include <string>

#include <lockstep/system.h>
#include "framework/foundation/math/limits.h"

namespace lockstep {

/// Part of the largest motion above which one is worth a word.
inline constexpr double kNotable = 0.1;
/// How much larger than another a motion must be to precede it: equal ones keep their order despite round-off.
inline constexpr double kLarger = 1 + kSlight;

/// Size of a small motion, 6 per slot: the largest move of a centre of mass, or rotation times System::length(), m.
LOCKSTEP_API double motion_size(const System&, const VecX& motion);

/// The bodies that move most, and how: "'crank' rotates about z, 'slider' moves along x". `motion`: 6 per slot, m
/// (world) and rad (slot axes); `at`: poses of the slots.
LOCKSTEP_API std::string motion_words(const System&, const Inputs& at, const VecX& motion);

/// The same with one slot first: "'crank' rotates about z; 'coupler', 'rocker' follow".
std::string led_motion_words(const System&, const Inputs& at, const VecX& motion, int leader);

}  // namespace lockstep
