// The lowest modes of a large mechanism by shift and invert on its sparse saddle-point matrix.
#pragma once

#include <lockstep/linearization.h>
#include "framework/tools/analysis/spectrum.h"

namespace lockstep {

/// The `count` eigenvalues (a pair counts once) nearest to zero, with vectors in the unknown velocities. `redundant`:
/// whether rows depend on one another. Throws SolveError where they do not settle.
Spectrum lowest_spectrum(const LinearMotion&, int count, bool redundant);

}  // namespace lockstep
