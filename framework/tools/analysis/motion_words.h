// A small motion of a mechanism in words.
#pragma once

#include <string>

#include <lockstep/system.h>

namespace lockstep {

/// Size of a small motion, 6 per slot: the largest move of a mass centre, or turn times System::length(), m.
double motion_size(const System&, const VecX& motion);

/// The bodies that move most, with what they do: "'crank' turns about z, 'slider' moves along x". `motion`: 6 per slot, m
/// (world) and rad (slot axes); `at`: where the slots are.
std::string motion_words(const System&, const Inputs& at, const VecX& motion);

/// A direction in the world: "z", "-x", "[0.6, 0.8, 0]".
std::string direction_words(const Vec3& direction);

}  // namespace lockstep
