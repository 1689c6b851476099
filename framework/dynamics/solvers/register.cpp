// SPDX-License-Identifier: BSD-3-Clause
#include "framework/description/registry/builtins.h"

#include <lockstep/author/registry.h>
#include <lockstep/solvers.h>

namespace lockstep {

void register_solvers(Registry& registry) {
  registry.solvers.add<DenseSolver>();
  registry.solvers.add<SchurSolver>();
  registry.solvers.add<SparseSolver>();
  registry.solvers.add<BlockSolver>();
}

}  // namespace lockstep
