#include "framework/dynamics/solvers/register.h"

#include "framework/dynamics/solvers/block_solver.h"
#include "framework/dynamics/solvers/dense_solver.h"
#include "framework/dynamics/solvers/schur_solver.h"
#include "framework/dynamics/solvers/sparse_solver.h"
#include "framework/description/registry/registry.h"

namespace lockstep {

void register_solvers(Registry& registry) {
  registry.solvers.add<DenseSolver>();
  registry.solvers.add<SchurSolver>();
  registry.solvers.add<SparseSolver>();
  registry.solvers.add<BlockSolver>();
}

}  // namespace lockstep
