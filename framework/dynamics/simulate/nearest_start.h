// The assembled start nearest to what was asked, by weights. Internal to assembly.
#pragma once

#include <lockstep/assembly.h>

namespace lockstep {

/// Moves the state onto its links and onto what is asked exactly, and then along what they leave free to where
///
///     sum over bodies of w (|dx|^2 + L^2 |turn|^2) + sum over coordinates of w d^2
///
/// is least; dx, turn: from the pose that the state begins with, d: from the value asked for, L = System::length(), turns
/// of coordinates times L. Throws AssemblyError with the names of what cannot be met, ModelError for an unknown name.
/// `follows`: what counts turns follows the way there, in short steps (short_share). Returns the rounds.
int nearest_start(Dynamics&, State&, const AssemblyOptions&, bool follows = false);

}  // namespace lockstep
