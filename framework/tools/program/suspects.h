// SPDX-License-Identifier: BSD-3-Clause
// Possible causes if a run did not conserve energy.
#pragma once

#include <vector>

#include "framework/tools/program/run_words.h"

namespace lockstep {

/// The likeliest first: forces whose potential, dissipation or supply do not fit their load (check_force() at a few
/// states near the start), singular configurations that the motion passed, constraint violation, unprojected stages in
/// loops with drives, long rotations in fixed steps. None if energy was conserved or cannot be judged, or if none of
/// them applies.
std::vector<Finding> suspects_of(const EndedRun&, System&, long n_passed);

}  // namespace lockstep
