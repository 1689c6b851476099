// SPDX-License-Identifier: BSD-3-Clause
// What makes steps short: the joint or force that changes most right after a state.
#pragma once

#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/error.h>

namespace lockstep {

/// For the end of a message: the constraint that contradicts others at this state; or the force or joint that changes
/// most within `after` seconds from it, with its values and the place; "" if nothing changes much. A NonFiniteError
/// of an evaluation is rethrown; of another error the text.
LOCKSTEP_API std::string who_varies(Dynamics&, const State&, double after);

/// Each row's number as Evaluation::norm counts it, m, or of rates m/s.
VecX row_sizes(const Evaluation&, const VecX&);

/// The constraint that is violated most at this state, "constraint z of joint 'H' by 1e-05 m"; "" if there is none.
LOCKSTEP_API std::string most_violated(Dynamics&, const State&);

/// The error of a step of h, s, from t, s, whose end could not be projected; names that constraint.
LOCKSTEP_API StepError end_not_projected(Dynamics&, const State& end, const ProjectReport&, const std::string& method,
                                         double t, double h);

}  // namespace lockstep
