// Plane: of a mechanism that moves in one. Three velocities a body: along i, along j, about n.
#pragma once

namespace lockstep {

struct Plane {
  int n = -1;  ///< its normal: 0 x, 1 y, 2 z of the world; -1: motion in space

  explicit operator bool() const { return n >= 0; }
  int i() const { return (n + 1) % 3; }
  int j() const { return (n + 2) % 3; }
  /// Which of a slot's six velocities is number k.
  int velocity(int k) const { return k == 0 ? i() : k == 1 ? j() : 3 + n; }
  friend bool operator==(const Plane&, const Plane&) = default;
};

}  // namespace lockstep
