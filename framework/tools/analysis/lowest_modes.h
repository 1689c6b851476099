// SPDX-License-Identifier: BSD-3-Clause
// The lowest modes of a large mechanism by its sparse saddle-point matrix.
#pragma once

#include <lockstep/linearization.h>

namespace lockstep {

/// A basis of motions on the constraints in which the `count` modes nearest to zero lie, in the unknown velocities: the
/// spectrum of the mechanism in it (spectrum_of()) is theirs. `redundant`: whether rows depend on one another. Throws
/// SolveError where they do not settle.
MatX lowest_motions(const LinearMotion&, int count, bool redundant);

}  // namespace lockstep
