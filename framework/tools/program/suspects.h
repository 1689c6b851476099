// SPDX-License-Identifier: BSD-3-Clause
// Who may be to blame where a run did not conserve energy.
#pragma once

#include <vector>

#include "framework/tools/program/run_words.h"

namespace lockstep {

/// The likeliest first: forces whose potential, dissipation or supply do not fit what they exert
/// (check_force() at a few states about the start), singular positions that the motion passed, links that the
/// stabilisation leaves open, stages off the constraints in loops with drives, long turns in fixed steps. None where energy
/// was conserved or cannot be judged, or where nothing of this is there.
std::vector<Finding> suspects_of(const EndedRun&, System&, long n_passed);

}  // namespace lockstep
