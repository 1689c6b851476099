// SPDX-License-Identifier: BSD-3-Clause
// Draw: random numbers that are the same on every machine, which those of the standard's distributions are not.
#pragma once

#include <cstdint>
#include <random>

#include <lockstep/math.h>

namespace lockstep {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : bits_(seed) {}

  /// In [low, high).
  double number(double low, double high) { return low + (high - low) * 0x1p-53 * static_cast<double>(bits_() >> 11); }
  /// Each component in [-size, size).
  Vec3 vector(double size) {
    const double x = number(-size, size), y = number(-size, size), z = number(-size, size);
    return {x, y, z};
  }
  /// A turn by a rotation vector with components in [-size, size).
  Quat turn(double size) { return exponential(vector(size)); }

 private:
  std::mt19937_64 bits_;
};

}  // namespace lockstep
