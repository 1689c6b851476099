// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/solver.h>

#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/scales.h"

namespace lockstep {

Factorization::~Factorization() = default;
LinearSolver::~LinearSolver() = default;

void Kkt::update_scales() {
  E.resize(pattern.m);
  row_diagonal(*this, E);  // S_jj = (J M^-1 J^T)_jj
  for (const KktLink& link : pattern.links)
    average_scales(E.data() + link.first_row, link.m, link.link < 0 ? KindBits() : KindBits(link.kind, link.m));
}

}  // namespace lockstep
