// SPDX-License-Identifier: BSD-3-Clause
// Frame: a body's frame, a marker or the world, and its coordinates relative to another one.
#pragma once

#include <lockstep/author/relative.h>
#include <lockstep/step_loop.h>
#include "framework/mechanism/lock/coordinate.h"

namespace lockstep::channels {

/// Stays valid through a new set-up of the system: it is folded into its slot again after each.
struct Frame : BodyOrMarker {
  /// The same, folded once for each set-up.
  const MarkerFrame& in(const System&) const;

  mutable MarkerFrame last{};  ///< as folded for the set-up of this number
  mutable long revision = -1;
};

/// The coordinates of frame m relative to frame n, as rows of locks have them (7.1), and their rates: the origin, n's
/// axes, and the quaternion e = q_n' q_m.
struct Relative {
  Vec3 x, v, a = Vec3::Zero();  ///< m, m/s, m/s^2
  Quat e, ed, edd{0, 0, 0, 0};
  Vec3 w() const { return 2.0 * (ed * conjugate(e)).vec(); }       ///< angular velocity, n's axes, rad/s
  Vec3 alpha() const { return 2.0 * (edd * conjugate(e)).vec(); }  ///< its rate, rad/s^2
  Vec3 w_in_m() const { return 2.0 * (conjugate(e) * ed).vec(); }  ///< the same in m's axes
  Vec3 alpha_in_m() const { return 2.0 * (conjugate(e) * edd).vec(); }
};
Relative relative(const Frame& m, const Frame& n, const Sample&);
/// With a and edd, which need the accelerations.
Relative relative_with_second(const Frame& m, const Frame& n, const Sample&);

}  // namespace lockstep::channels
