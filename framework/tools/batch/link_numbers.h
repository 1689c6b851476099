// SPDX-License-Identifier: BSD-3-Clause
// The numbers of a link in lanes: its markers and laws, in packs. Private to the room.
#pragma once

#include <span>
#include <string>

#include <lockstep/author/lock.h>
#include <lockstep/state.h>
#include "framework/tools/batch/lane_plan.h"

namespace lockstep::lanes {

/// Why a link has no rows in lanes; "" if it has.
std::string unsuited_link(const Lock&);
/// How the turn of a lock that has rows of turns is calculated.
Turn turn_of(const MarkerLock&);
/// Writes the markers of one copy's lock; where they are not parallel, the link's turn is no more Turn::parallel.
void put_frames(const MarkerLock&, int lane, Link&, std::span<double> frames);
/// Writes the laws of one copy's lock. Throws what they throw.
void put_laws(const MarkerLock&, int lane, const Link&, const Inputs&, std::span<double> laws);

}  // namespace lockstep::lanes
