// SPDX-License-Identifier: BSD-3-Clause
// Who makes steps short: the link or force that changes most right after a state.
#pragma once

#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>

namespace lockstep {

/// In words for the end of a message: which row contradicts others at this state; or which force or link changes most
/// within `after` seconds from it, with its values and the place; "" where nothing changes much. What an evaluation
/// throws there is said instead.
LOCKSTEP_API std::string who_varies(Dynamics&, const State&, double after);

/// The row that is violated most at this state, "row z of link 'H' by 1e-05 m"; "" where there are no rows.
LOCKSTEP_API std::string most_violated(Dynamics&, const State&);

/// end_not_projected() with that row, at the end of the step.
StepError end_not_projected_by(Dynamics&, const State& end, const ProjectReport&, const std::string& method, double t,
                               double h);

}  // namespace lockstep
