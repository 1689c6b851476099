// The slots' own coordinates of a state.
#pragma once

#include <lockstep/state.h>
#include <lockstep/system.h>

namespace lockstep {

/// Takes a state to the slots' own coordinates, if it is in others: poses and velocities are kept.
LOCKSTEP_API void to_slot_coordinates(const System&, State&);

}  // namespace lockstep
