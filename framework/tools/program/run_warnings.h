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
/// Warns of a mechanism without a freedom, that no law moves and no event releases, and says so; not of one with more
/// unknown velocities than `most`, of which it costs too much to know.
bool warn_of_no_freedom(const Mechanism&, Dynamics&, StepLoop&, int most);
/// Whether a recorded column is a reaction.
bool records_reactions(const RunSettings&);
/// The recorded columns that hold reactions which are not unique at the start.
std::vector<std::string> columns_not_unique(Dynamics&, const State& start, const RunSettings&);

}  // namespace lockstep
