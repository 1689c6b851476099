// SPDX-License-Identifier: BSD-3-Clause
// What friction carries of the forces on a mechanism at rest.
#pragma once

#include <vector>

#include <lockstep/equilibrium.h>
#include "framework/tools/analysis/forces_at_rest.h"
#include "framework/tools/analysis/rest_matrices.h"

namespace lockstep {

/// Forces of friction that balance the forces which the rows leave.
struct FrictionLoad {
  bool balances = false;          ///< whether there are any, however large; the rest is only then filled in
  bool holds = false;             ///< whether some are within their limits
  std::vector<GripReport> grips;  ///< what each carries, and its limit under the reactions there
  VecX lambda;                    ///< multipliers, 1 per row
  MatX ungripped;                 ///< free motions that no friction holds, in the unknowns of the matrices
};

/// The least forces of friction, each by its limit, that balance the forces at this state; where those are beyond a
/// limit, the ones whose largest share of a limit is least.
FrictionLoad friction_load(Dynamics&, const ForcesAtRest&, const RestMatrices&);

}  // namespace lockstep
