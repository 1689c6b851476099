// The passes of the solver `schur` over all nodes; each is compiled for every instruction set (foundation/support/clones.h).
#pragma once

#include "framework/dynamics/solvers/schur_kernels.h"

namespace lockstep::schur {

void fill(const Plan&, const Numbers&);                    ///< rows -> Y, S + E
void factor(const Plan&, const Numbers&);                  ///< S + E -> L, D
void start(const Plan&, const double* c, const Numbers&);  ///< x = J a_f - c and scales; c one a row of the table
void solve(const Plan&, const Numbers&);  ///< x <- (S + E)^-1 x; a hub's part of x is its a, of fewer digits
void apply(const Plan&, const double* x, const Numbers&);    ///< a -= Y^T x
void residual(const Plan&, const Numbers&);                  ///< r = J a - c
bool within(const Plan&, double tolerance, const Numbers&);  ///< |r| of every row against its scale

}  // namespace lockstep::schur
