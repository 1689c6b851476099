// Whether a run can go on from a state, and what is done to it so that it can. Internal to the step loop; limits in m
// and m/s.
#pragma once

#include <string>
#include <vector>

#include <lockstep/dynamics.h>

namespace lockstep {

/// Throws AssemblyError, naming the row that is violated most, where a start violates the constraints.
void check_start(Dynamics&, const State&, double limit);
/// The own states of links that come into force: a driven speed begins where the mechanism is.
void engage_links(Dynamics&, State&, const std::vector<std::string>& links);
/// A link can be put in force only where its constraint holds already: else AssemblyError, naming `cause`.
void check_links(Dynamics&, const State&, const std::vector<std::string>& links, const std::string& cause,
                 double limit);
/// Onto the constraints where positions are projected (by less than the limit: more is an AssemblyError); velocities
/// always: an inelastic impact. Memory follows.
void make_consistent(Dynamics&, State&, const std::string& cause, double limit);

}  // namespace lockstep
