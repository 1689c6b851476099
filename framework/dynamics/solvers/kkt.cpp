#include "framework/dynamics/solvers/kkt.h"

#include "framework/dynamics/solvers/products.h"

namespace lockstep {

namespace {

// A link without a slot, or one whose rows vanish, has no scale of its own; any positive number keeps the matrix
// definite.
double positive(double s) { return s > 0.0 ? s : 1.0; }

}  // namespace

void Kkt::update_scales() {
  E.resize(pattern.m);
  row_diagonal(*this, E);  // S_jj = (J M^-1 J^T)_jj
  for (const KktLink& link : pattern.links) {
    for (const RowKind kind : {RowKind::translation, RowKind::rotation}) {
      double sum = 0.0;
      int n_rows = 0;
      for (int k = 0; k < link.m; ++k)
        if (kind_of(link, k) == kind) sum += E[link.first_row + k], ++n_rows;
      for (int k = 0; k < link.m; ++k)
        if (kind_of(link, k) == kind) E[link.first_row + k] = sum / n_rows;
    }
  }
  for (double& s : E) s = positive(s);
}

}  // namespace lockstep
