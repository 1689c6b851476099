// SPDX-License-Identifier: BSD-3-Clause
// The motion of a slot from a state, for inner loops.
#pragma once

#include <lockstep/state.h>

namespace lockstep {

/// Writes the motion of a slot >= 0 to `out`, with the quaternion normalised.
inline void read_motion(const State& state, int slot, Motion& out) {
  if (state.coordinates) {
    out = state.coordinates->motion(state, slot);
    return;
  }
  out.x = state.q.segment<3>(7 * slot);
  out.e = normalized(Quat::from(state.q.segment<4>(7 * slot + 3)));
  out.A = rotation(out.e);
  out.v = state.v.segment<3>(6 * slot);
  out.w = state.v.segment<3>(6 * slot + 3);
}

}  // namespace lockstep
