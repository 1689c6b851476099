// SPDX-License-Identifier: BSD-3-Clause
// The passes of the solver `schur`; each is compiled for every instruction set (LOCKSTEP_CLONES).
#pragma once

#include "framework/dynamics/solvers/elimination.h"
#include "framework/foundation/support/clones.h"

namespace lockstep::schur {

void fill(const Plan&, const Numbers&);                    ///< rows -> Y, S + E
void factor(const Plan&, const Numbers&);                  ///< S + E -> L, D
void start(const Plan&, const double* c, const Numbers&);  ///< c (one per row of the table) turned; x = J a - c, scales
void solve(const Plan&, const Numbers&);  ///< x <- (S + E)^-1 x; a hub's part of x is its a, with fewer digits
void apply(const Plan&, const double* x, const Numbers&);      ///< a -= Y^T x
void residual(const Plan&, const Numbers&);                    ///< r = J a - c
bool rows_met(const Plan&, double tolerance, const Numbers&);  ///< |r| of every row is within its scale

}  // namespace lockstep::schur
