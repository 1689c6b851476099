#include "framework/kkt/linear_solver.h"

namespace lockstep {

LinearSolver::~LinearSolver() = default;

}  // namespace lockstep
