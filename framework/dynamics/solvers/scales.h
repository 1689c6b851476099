// The scales s_j of the rows, in which the proximal term E = eps s_j is measured (framework/docs/solvers.md, section 5).
#pragma once

#include "framework/mechanism/rows/rows.h"

namespace lockstep {

/// The diagonal S_jj = (J M^-1 J^T)_jj of one link's rows becomes s_j: the mean over the force rows for those, over the
/// moment rows for those, its own number for a function. Reactions of redundant rows then depend on no frame. A link
/// without a slot, or one whose rows vanish, has no scale of its own; any positive number keeps the matrix definite.
/// kind(k): RowKind of row k. T: double, or a pack of them, one per copy.
template <class T, class Kind>
[[gnu::always_inline]] inline void average_scales(T* s, int m, const Kind& kind) {
  T t{}, r{};
  int n_t = 0, n_r = 0;
  for (int k = 0; k < m; ++k) {
    t += kind(k) == RowKind::translation ? s[k] : T{}, n_t += kind(k) == RowKind::translation;
    r += kind(k) == RowKind::rotation ? s[k] : T{}, n_r += kind(k) == RowKind::rotation;
  }
  t = t / static_cast<double>(n_t > 0 ? n_t : 1), r = r / static_cast<double>(n_r > 0 ? n_r : 1);
  for (int k = 0; k < m; ++k) {
    const T mean = kind(k) == RowKind::translation ? t : kind(k) == RowKind::rotation ? r : s[k];
    s[k] = mean > 0.0 ? mean : T{} + 1.0;
  }
}

}  // namespace lockstep
