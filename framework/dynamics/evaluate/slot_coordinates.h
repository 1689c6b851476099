// SPDX-License-Identifier: BSD-3-Clause
// The slots' own coordinates of a state, and whether it is one of the system.
#pragma once

#include <lockstep/state.h>
#include <lockstep/system.h>

namespace lockstep {

/// Sets up the system if need be; throws ModelError if the state is of another one.
inline void check_state(System& system, const State& state) {
  system.setup();
  system.check_size(state);
}

/// Takes a state to the slots' own coordinates, if it is in others: poses and velocities are kept.
LOCKSTEP_API void to_slot_coordinates(const System&, State&);

}  // namespace lockstep
