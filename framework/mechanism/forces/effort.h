// Effort: what a motor or an applied load gives between two markers, a force or a torque; all that differs between them.
#pragma once

#include "framework/mechanism/forces/formula.h"

namespace lockstep {

enum class Effort {
  force,   ///< N, on P's body at the origin of P, the opposite on S's body at the same point; works on its velocity
  torque,  ///< N m, on P's body, the opposite on S's; works on the angular velocity
};

/// "force" or "torque": the key in scenes and the word in messages and channels.
inline const char* word(Effort e) { return e == Effort::force ? "force" : "torque"; }
inline const char* unit(Effort e) { return e == Effort::force ? "N" : "N m"; }

/// Puts the effort f (world axes) between the bodies.
template <class T, class Load>
void exert(Effort e, const Vec3T<T>& f, const Ends<T>& at, Load& load) {
  if (e == Effort::force)
    load.force(f, at.P.x());
  else
    load.torque(f);
}

/// Velocity of the origin of P, m/s, or angular velocity of P, rad/s, as seen from S; world axes.
template <class T>
Vec3T<T> rate_from_s(Effort e, const Ends<T>& at) {
  if (e == Effort::torque) return at.P.w() - at.S.w();
  return at.P.v() - at.S.v() - cross(at.S.w(), Vec3T<T>(at.P.x() - at.S.x()));
}

}  // namespace lockstep
