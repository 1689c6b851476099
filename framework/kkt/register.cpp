#include "framework/kkt/register.h"

#include "framework/kkt/block_solver.h"
#include "framework/kkt/dense_solver.h"
#include "framework/kkt/schur_solver.h"
#include "framework/kkt/sparse_solver.h"
#include "framework/plugin/registry.h"

namespace lockstep {

void register_solvers(Registry& registry) {
  registry.solvers.add<DenseSolver>();
  registry.solvers.add<SchurSolver>();
  registry.solvers.add<SparseSolver>();
  registry.solvers.add<BlockSolver>();
}

}  // namespace lockstep
