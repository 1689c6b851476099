#include <lockstep/author/solver.h>

namespace lockstep {

Factorization::~Factorization() = default;
LinearSolver::~LinearSolver() = default;

}  // namespace lockstep
