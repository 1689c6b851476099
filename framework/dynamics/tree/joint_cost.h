// SPDX-License-Identifier: BSD-3-Clause
// Whether an evaluation along the joints of a tree costs less than one in omega, by the operations of both.
#pragma once

#include "framework/dynamics/solvers/operations.h"
#include "framework/dynamics/tree/closure_fronts.h"

namespace lockstep {

/// Of the motions and accelerations of a tree, and of the rows of `closures`, once they are written, eliminated along it.
LOCKSTEP_API Operations count_operations(const JointTree&, const ClosureFronts&, const RowTable& closures);

/// Of the same in omega, where all links in force have rows; what links write of `closures` costs the same in both, and is in
/// neither.
LOCKSTEP_API Operations count_in_omega(const System&, const std::vector<bool>& modes, const RowTable& closures);

/// What makes joint coordinates the dearer ones, with these links in force; "" if they are not. They are where they
/// take more operations than omega, or rows may be redundant and integrated states read accelerations or reactions,
/// which omega gives at every evaluation (framework/docs/solvers.md, section 9).
std::string why_dearer(const JointTree&, const ClosureFronts&, const RowTable& closures, const System&,
                       const std::vector<bool>& modes);

}  // namespace lockstep
