// SPDX-License-Identifier: BSD-3-Clause
// The way back of a mechanism that moves in a plane and was looked at in space.
#pragma once

#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/equilibrium.h>

namespace lockstep {

/// A state at rest, and what was found of it.
struct AtRest {
  State& state;
  EquilibriumReport& report;
};

/// The largest move of a centre of mass between two states, and its body.
void measure_move(const System&, const State& from, const State& to, EquilibriumReport&);

/// Ends a look in space: where all of `found` lie in the plane, as `start` does, the system goes back to it, with their
/// multipliers; else it stays in space.
void go_back_to_plane(Dynamics&, System::InSpace& look, const State& start, const std::vector<AtRest>& found);

}  // namespace lockstep
