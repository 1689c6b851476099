// SPDX-License-Identifier: BSD-3-Clause
// The one line search: shares of a step from a state.
#pragma once

#include <lockstep/state.h>

namespace lockstep {

constexpr double kLeastShare = 0x1p-10;  ///< of a step, or a part of one: less is not tried

/// Tries the shares 1, 1/2, 1/4, ..., kLeastShare of a step until `accepts(share)`, which moves the state and judges
/// it; each begins at the state as it is now. Returns whether one was accepted; else the state is the one before.
template <class Accepts>
bool search_line(State& state, Accepts&& accepts) {
  const State from = state;
  for (double share = 1; share >= kLeastShare; share *= 0.5) {
    if (accepts(share)) return true;
    state = from;
  }
  return false;
}

}  // namespace lockstep
