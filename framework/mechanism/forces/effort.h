// SPDX-License-Identifier: BSD-3-Clause
// What the formulas of built-in forces share.
#pragma once

#include <lockstep/author/formula.h>
#include <lockstep/forces.h>

namespace lockstep {

/// "force" or "torque": the key in scenes, and the word in messages and channels.
inline const char* word(Effort e) { return e == Effort::force ? "force" : "torque"; }
/// "N" or "N m".
inline const char* unit(Effort e) { return e == Effort::force ? "N" : "N m"; }
/// The last of the quantities of a FormulaForce.
inline Quantity power() { return {"power", "W", "power of the force on the bodies"}; }

/// Exerts f, N or N m, world axes, on P's body and the opposite on S's.
template <class T, class Load>
void exert(Effort e, const Vec3T<T>& f, const Ends<T>& at, Load& load) {
  if (e == Effort::force)
    load.force(f, at.P.x());
  else
    load.torque(f);
}

/// Velocity of the origin of P, m/s, or angular velocity of P, rad/s, as seen from S, in world axes.
template <class T>
Vec3T<T> rate_from_s(Effort e, const Ends<T>& at) {
  if (e == Effort::torque) return at.P.w() - at.S.w();
  return at.P.v() - at.S.v() - cross(at.S.w(), Vec3T<T>(at.P.x() - at.S.x()));
}

// LinearSpring: spring, damper and actuator in one coordinate q: a length, N and m, or an angle, N m and rad.

/// A spring, damper and actuator that pull their coordinate q back; qd is its rate.
///
///     force         T = k (q - q0) + T0 + c qd + law(t)
///     potential     V = 1/2 k (q - q0)^2 + T0 (q - q0)
///     dissipation   D = c qd^2
///     supply        -law(t) qd
struct LinearSpring {
  double stiffness,  ///< k, N/m or N m/rad
      damping,       ///< c, N s/m or N m s/rad
      free,          ///< q0, m or rad
      preload;       ///< T0, N or N m

  /// T, N or N m, at q with the rate qd and the value of the law; energies go to `load`.
  template <class T, class Load>
  T force(const T& q, const T& rate, double law, Load& load) const {
    const T x = q - free, elastic = stiffness * x;
    load.stores((0.5 * elastic + preload) * x);
    load.dissipates(damping * rate * rate);
    load.supplies(-law * rate);
    return elastic + preload + damping * rate + law;
  }
};

}  // namespace lockstep
