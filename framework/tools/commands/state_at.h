// SPDX-License-Identifier: BSD-3-Clause
// A state of a scene's mechanism at one time, for the commands that analyse one.
#pragma once

#include <memory>
#include <string>

#include "framework/tools/analysis/mechanism_at.h"
#include "framework/tools/program/commands.h"

namespace lockstep {

/// The time of --at, s; 0 if none is given. Throws UsageError.
double instant_of(const Arguments&);

/// Runs the mechanism to a time by the scene's settings, from its assembled start; at t = 0 that is the state, in the
/// slots' own coordinates. Channels may add integrated states: make other dynamics of the mechanism afterwards. Throws
/// what a run throws, and ModelError if an event ends the run before.
State run_to(Mechanism&, const Registry&, double t);
/// The same with separate dynamics.
MechanismAt state_at(std::unique_ptr<Mechanism>, const Registry&, double t);

/// "translation", "rotation", "function".
std::string word_of(RowKind);

}  // namespace lockstep
