// SPDX-License-Identifier: BSD-3-Clause
// What is said of a run before it begins: settings without effect, starts that leave a choice, columns that are not unique.
#pragma once

#include <string>
#include <vector>

#include <lockstep/sweep.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// Warns, one line each, of settings that have no effect, or hardly the one that was meant.
void warn_of_settings(const Scene&, const Mechanism&, const Arguments&, StepLoop&);
/// Warns of a start in a singular position, where the rows alone do not say how the motion continues.
void warn_of_branches(Dynamics&, StepLoop&);
/// What keeps a run of the mechanism as it stands from joint coordinates, at a start: "rows of link 'high' that depend on
/// others are left out", "integrator radau5 does not take joint coordinates"; "" if nothing does.
std::string why_not_joint(const RunSettings&, Dynamics&, const State& start, const Registry&);
/// Refuses joint coordinates that are asked for by name and are not possible, before a run opens a file. Throws
/// ModelError; what else is wrong with the scene is left for the run to say.
void refuse_impossible_formulation(const RunSettings&, const Loaded&);
/// Warns of a mechanism without a freedom, where no law moves it, no event releases a link and no link is one-sided; not
/// of one with more unknown velocities than `most`, of which it costs too much to know.
void warn_of_no_freedom(const Mechanism&, Dynamics&, StepLoop&, int most);
/// The recorded columns that hold reactions which are not unique at the start.
std::vector<std::string> columns_not_unique(Dynamics&, const State& start, const RunSettings&);

}  // namespace lockstep
