// SPDX-License-Identifier: BSD-3-Clause
// Random starts of a mechanism, projected onto its constraints, and distances of poses.
#pragma once

#include <string>

#include <lockstep/detail/export.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include "framework/tools/check/draw.h"

namespace lockstep {

/// Moves every slot by up to `size`, m, along each axis, and rotates it at random; in a plane within it and about its
/// normal.
LOCKSTEP_API void scatter(const System&, double size, Draw&, State&);

/// Newton's method onto the rows, with halved steps where one does not reduce |C|. False if it ends elsewhere, or where
/// rows are not finite or contradict one another on the way. The state is in the slots' own coordinates.
bool fit(Dynamics&, State&);

/// What `act` returns; false where the equations have no solution, or numbers are not finite.
template <class Act>
bool solvable(Act&& act) {
  try {
    return act();
  } catch (const SolveError&) {
  } catch (const NonFiniteError&) {
  }
  return false;
}

/// Largest distance of a centre of mass between two states, or rotation times System::length(), m; `body`: takes its
/// name.
LOCKSTEP_API double apart(const System&, const State& a, const State& b, std::string* body = nullptr);

}  // namespace lockstep
