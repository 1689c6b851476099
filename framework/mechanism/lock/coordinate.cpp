// SPDX-License-Identifier: BSD-3-Clause
#include "framework/mechanism/lock/coordinate.h"

namespace lockstep {

MarkerFrame BodyOrMarker::folded() const {
  if (marker != nullptr) return MarkerFrame(*marker);
  MarkerFrame f;
  if (body == nullptr) return f;
  f.slot = body->slot;
  const Pose& p = body->fixed ? body->home : body->in_slot;
  f.u0 = f.home.u = p.x, f.q0 = f.home.q = normalized(p.q), f.A0 = f.home.A = rotation(f.q0);
  return f;
}

Dimension Coordinate::dimension() const {
  Dimension d = dimension_of(turns() ? Unit::angle : Unit::length);
  d.s = -of_.order;
  return d;
}

void Coordinate::count_angles(AngleCounter& counter) {
  if (of_.kind == Kind::turn) angle_ = &counter.count(*m_.marker, *n_.marker, of_.axis);
}

}  // namespace lockstep
