// Pose: position and orientation of a frame in its parent. Twist: how fast it moves.
#pragma once

#include "framework/foundation/math/quaternion.h"

namespace lockstep {

/// x: origin in the parent's axes, m; q: frame's axes -> parent's axes, unit, scalar first.
struct Pose {
  Vec3 x = Vec3::Zero();
  Quat q;
};

/// v: velocity of the origin in the parent's axes, m/s; w: angular velocity in the frame's own axes, rad/s.
struct Twist {
  Vec3 v = Vec3::Zero();
  Vec3 w = Vec3::Zero();
};

/// The pose of c in the parent of a, when b is the pose of c in a.
inline Pose operator*(const Pose& a, const Pose& b) { return {a.x + rotation(a.q) * b.x, a.q * b.q}; }

inline Pose inverse(const Pose& a) { return {-(rotation(a.q).transpose() * a.x), conjugate(a.q)}; }

}  // namespace lockstep
