// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include <lockstep/solvers.h>

namespace lockstep {

void register_solvers(Registry& registry) {
  add_types<DenseSolver, SchurSolver, SparseSolver, BlockSolver>(registry.solvers);
}

}  // namespace lockstep
