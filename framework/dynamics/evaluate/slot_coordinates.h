// SPDX-License-Identifier: BSD-3-Clause
// The slots' own coordinates of a state, and whether states and vectors are those of the system.
#pragma once

#include <lockstep/state.h>
#include <lockstep/system.h>

namespace lockstep {

/// Sets up the system if need be; throws ModelError if the state is of another one.
inline void check_state(System& system, const State& state) {
  system.setup();
  system.check_size(state);
}

/// Throws ModelError for a vector, `what` in words, that has not n numbers.
inline void check_size(const char* what, Eigen::Index size, Eigen::Index n) {
  if (size != n)
    throw ModelError(std::string(what) + " has " + std::to_string(size) + " numbers, but " + std::to_string(n) +
                     " are needed; resize it (6 per rigid group, 1 per constraint)");
}

/// Takes a state to the slots' own coordinates, if it is in others: poses and velocities are kept.
LOCKSTEP_API void to_slot_coordinates(const System&, State&);

}  // namespace lockstep
