// SPDX-License-Identifier: BSD-3-Clause
// RowSpace: what rows hold, what they leave free, and how they depend on one another, by one factorisation.
#pragma once

#include <limits>
#include <vector>

#include "framework/foundation/math/decompositions.h"
#include "framework/foundation/math/limits.h"
#include "framework/foundation/math/sparse.h"

namespace lockstep {

/// Pivots up to this, of rows of length 1, are zero: round-off of a loop of some hundred rows, with two digits to spare.
inline constexpr double kDependent = 1e-11;
/// Rows of pivots from kDependent to this nearly depend on others: too much for round-off, too little for a mechanism.
/// Of S they leave pivots below kSmallPivot, its square, which solvers take for those of redundant rows.
inline constexpr double kNearlyDependent = 1e-3;
/// Of a combination of rows: a row with a smaller share takes no part. Round-off over a pivot of 1e-9.
inline constexpr double kShare = std::numeric_limits<double>::epsilon() / kNegligible;
/// Loops of more rows are factored sparsely.
inline constexpr int kDenseRows = 300;

/// Rows that depend on one another, and on no others: circuits, combinations of rows that are zero, connect them,
/// whichever rows are taken as the independent ones.
struct DependentRows {
  std::vector<int> rows;  ///< numbers of the rows, ascending
  int too_many = 0;       ///< how many of them are redundant
  int nearly = 0;         ///< and how many nearly are
  double pivot = 0;       ///< the largest pivot of those that nearly are, of rows of length 1
};

/// Rows, scaled to length 1 and factored with the largest pivot first:
///
///     Jt P = Q (R1 R2; 0 0),   N = Q (0; 1),   Jt P (-R1^-1 R2; 1) = 0
class LOCKSTEP_API RowSpace {
 public:
  /// Jt: rows transposed, of any length. Throws NonFiniteError.
  explicit RowSpace(const SparseMat& Jt);

  int rank(double limit = kDependent) const { return qr_.rank(limit); }  ///< pivots up to `limit` are zero
  int nearly(double least = kDependent) const { return rank(least) - rank(kNearlyDependent); }
  double pivot(int place) const { return qr_.pivot(place); }
  double smallest_singular_value(int rank) const;         ///< of so many pivots; below 1e-7 it is rounding
  double length(int row) const { return lengths_[row]; }  ///< 1 for a row of zeros
  /// N: what they leave free, orthonormal columns.
  MatX free(double limit = kDependent) const { return qr_.rest(rank(limit)); }
  VecX free_part(const VecX& u) const;  ///< N N^T u
  /// How the row of a place depends on those of the first places: shares of rows of length 1, the largest is 1.
  VecX circuit(int place, int regular) const;
  /// Combinations of rows as they were given that are zero, one a column: of rows of length 1 the largest share is 1.
  MatX circuits(double limit = kDependent) const;
  /// Rows that depend on others, nearly ones too, in sets that share none.
  std::vector<DependentRows> sets() const;

 private:
  int n_rows() const { return static_cast<int>(lengths_.size()); }
  int row_at(int place) const { return qr_.column[place]; }

  VecX lengths_;
  PivotedQr qr_;
};

/// The dependencies of the rows of a loop, of any number. Beyond kDenseRows singular values below 1e-6 are zero, all
/// dependent rows are one set, and of their circuits there are some combinations at random.
struct LOCKSTEP_API Dependencies {
  explicit Dependencies(const SparseMat& Jt, double limit = kDependent);
  int rank = 0;
  std::vector<DependentRows> sets;
  MatX circuits;         ///< as RowSpace::circuits()
  double round_off = 0;  ///< shares up to this are zero
};

}  // namespace lockstep
