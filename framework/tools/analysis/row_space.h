// RowSpace: what rows hold, what they leave free, and how they depend on one another, by one factorisation.
#pragma once

#include <vector>

#include <Eigen/QR>

#include <lockstep/body.h>

namespace lockstep {

/// Pivots below this, of rows of length 1, are zero.
inline constexpr double kDependent = 1e-9;
/// Rows of pivots from kDependent to this nearly depend on others: too much for round-off, too little for a mechanism.
/// Proximal terms are larger than what such rows leave of S, so that solvers would take them for redundant.
inline constexpr double kNearlyDependent = 1e-4;
/// Of a combination of rows: a row with a smaller share takes no part.
inline constexpr double kShare = 1e-7;

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
class RowSpace {
 public:
  /// Jt: rows transposed, of any length.
  explicit RowSpace(MatX Jt);

  int rank() const { return above(kDependent); }
  int nearly() const { return rank() - above(kNearlyDependent); }  ///< how many of these rows nearly depend on others
  MatX free() const;                                               ///< N: what they leave free, orthonormal columns
  /// Combinations of rows that are zero, but for pivots up to this: one a column.
  MatX circuits(double pivot = kDependent) const;
  /// Rows that depend on others, nearly ones too, in sets that share none.
  std::vector<DependentRows> sets() const;

 private:
  int n_rows() const { return static_cast<int>(lengths_.size()); }
  int above(double limit) const;
  double pivot(int place) const;
  int row_at(int place) const { return static_cast<int>(qr_.colsPermutation().indices()[place]); }
  MatX shares(int regular) const;  // R1^-1 R2 of so many pivots

  Eigen::Index n_;  // unknowns
  VecX lengths_;
  Eigen::ColPivHouseholderQR<MatX> qr_;
};

}  // namespace lockstep
