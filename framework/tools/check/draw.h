// Draw: random numbers that are the same on every machine (splitmix64: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014).
#pragma once

#include <cstdint>

#include <lockstep/math.h>

namespace lockstep {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}

  /// In [low, high).
  double number(double low, double high) { return low + (high - low) * 0x1p-53 * static_cast<double>(next() >> 11); }
  /// Each component in [-size, size).
  Vec3 vector(double size) {
    const double x = number(-size, size), y = number(-size, size), z = number(-size, size);
    return {x, y, z};
  }
  /// A turn by a rotation vector with components in [-size, size).
  Quat turn(double size) { return exponential(vector(size)); }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace lockstep
