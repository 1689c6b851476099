// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/solver.h>

namespace lockstep {

Factorization::~Factorization() = default;
LinearSolver::~LinearSolver() = default;

}  // namespace lockstep
