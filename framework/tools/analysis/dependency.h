// Linear dependencies among rows: their rank, and which rows depend on one another.
#pragma once

#include <vector>

#include "framework/tools/analysis/loop_rows.h"
#include "framework/tools/analysis/row_space.h"

namespace lockstep {

/// Rank and dependencies of rows.
struct Dependencies {
  int rank = 0;
  std::vector<DependentRows> sets;
};

/// Of the rows of a loop. Beyond 300 rows they are factored sparsely: singular values below 1e-6 are zero then, and all
/// dependent rows are one set. Throws NonFiniteError where a number is not finite.
Dependencies find_dependencies(const LoopRows&);

/// Combinations of rows that are zero; largest number 1.
struct NullVectors {
  MatX columns;          ///< one vector a column: a basis; beyond 300 rows eight of them at random
  double round_off = 0;  ///< numbers up to this are zero
  int n = 0;             ///< how many independent ones there are
};
/// As above; but for pivots up to this, where more than kDependent are asked for.
NullVectors null_vectors(const LoopRows&, double pivot = kDependent);

}  // namespace lockstep
