// From a quaternion on jets of time to a RotationValue.
#pragma once

#include "framework/foundation/math/jet.h"
#include "framework/mechanism/model/motion_law.h"

namespace lockstep {

/// Of r(t) with its derivatives, of any length but zero: q = r/|r|, and by (1.6) w = G(q) qd, a = G(q) qdd (for G(qd)
/// qd = 0).
inline RotationValue rotation_value(const QuatT<Time>& r) {
  const QuatT<Time> q = normalized(r);
  const Mat34 G = G_matrix(Quat{q.w.v, q.x.v, q.y.v, q.z.v});
  return {{q.w.v, q.x.v, q.y.v, q.z.v}, G * Vec4(q.w.d, q.x.d, q.y.d, q.z.d), G * Vec4(q.w.h, q.x.h, q.y.h, q.z.h)};
}

}  // namespace lockstep
