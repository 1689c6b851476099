#include "framework/dynamics/solvers/linear_solver.h"

namespace lockstep {

Factorization::~Factorization() = default;
LinearSolver::~LinearSolver() = default;

}  // namespace lockstep
