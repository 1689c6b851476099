#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

LinearSolver::~LinearSolver() = default;

}  // namespace lockstep
