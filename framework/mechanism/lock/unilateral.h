// Unilateral: what makes a link of one row push and not pull.
#pragma once

namespace lockstep {

/// C >= 0 in place of C = 0. The link is out of force until C falls to zero; then the simulation gives the impact, and
/// where that leaves no speed worth an impact, the link holds until it would have to pull.
struct Unilateral {
  double restitution = 0;    ///< speed of C after an impact to that before it, 0 to 1
  double rest_speed = 1e-3;  ///< impacts that leave less end at rest, m/s (rad/s); above zero
  bool below = false;        ///< C <= 0 is free in place of C >= 0 (a rope: the distance may be less than its length)
  double sign() const { return below ? -1.0 : 1.0; }
};

}  // namespace lockstep
