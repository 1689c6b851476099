// SPDX-License-Identifier: BSD-3-Clause
// Warnings before a run: settings without effect, singular starts, reactions that are not unique.
#pragma once

#include <optional>

#include <lockstep/step_loop.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/rank/branch_point.h"

namespace lockstep {

/// Settings that have no effect, or probably not the intended one. `adaptive`: whether the integrator is.
std::vector<Finding> settings_to_warn_of(const Scene&, const Mechanism&, const Arguments&, bool adaptive);
/// Warns of a start in a singular configuration, from which the motion may continue in several ways. Returns what it is.
BranchPoint warn_of_branches(Dynamics&, StepLoop&);
/// Throws ModelError if joint coordinates are requested and not possible, before a run opens a file. Other errors of
/// the scene are left to the run.
void refuse_impossible_formulation(const RunSettings&, const Loaded&);
/// Throws the error of a law that has no value at the end of the run, such as a table that is shorter, unless an event
/// may stop the run or release a joint before.
void refuse_short_laws(const Mechanism&, Dynamics&, const State& start);
/// Joints whose laws move their constraints from t = 0 s to `until`: Ct, or C of bodies at rest, at some times. None: a law
/// fails before it moves any, which the run reports.
std::optional<std::vector<std::string>> moved_by_laws(Dynamics&, State, double until);
inline constexpr int kManyVelocities = 3000;  ///< unknown; the degrees of freedom of more are not counted
/// Warns of a mechanism without a degree of freedom, unless a law moves it, an event releases a joint or a joint is
/// one-sided. Not of one with more unknown velocities than `most`, as the count costs too much.
void warn_of_no_freedom(const Mechanism&, Dynamics&, StepLoop&, int most);

}  // namespace lockstep
