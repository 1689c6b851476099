// Linear dependencies among rows: their rank, and which rows depend on one another.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <lockstep/body.h>

namespace lockstep {

/// Rows that depend on one another, and on no others: circuits, combinations of rows that are zero, connect them,
/// whichever rows are taken as the independent ones.
struct DependentRows {
  std::vector<int> rows;  ///< numbers of the rows, ascending
  int too_many = 0;       ///< how many of them are redundant
  int nearly = 0;         ///< and how many nearly are
  double pivot = 0;       ///< the largest pivot of those that nearly are, of rows of length 1
};

/// Rank and dependencies of a matrix.
struct Dependencies {
  int rank = 0;
  std::vector<DependentRows> sets;
};

/// Pivots below this are zero.
inline constexpr double kDependent = 1e-9;
/// Rows of pivots from kDependent to this nearly depend on others: too much for round-off, too little for a mechanism.
/// Proximal terms are larger than what such rows leave of S, so that solvers would take them for redundant.
inline constexpr double kNearlyDependent = 1e-4;

/// Jt: the matrix transposed, its columns the rows, of length 1 or zero; in triplets, since most of it is zero. Beyond
/// 300 rows they are factored sparsely: singular values below 1e-6 are zero then, and all dependent rows are one set. Throws
/// NonFiniteError where a number is not finite.
Dependencies find_dependencies(int n_columns, int n_rows, const std::vector<Eigen::Triplet<double>>& Jt);

/// Combinations of rows that are zero, with pivots as above; largest number 1.
struct NullVectors {
  MatX columns;          ///< one vector a column: a basis; beyond 300 rows eight of them at random
  double round_off = 0;  ///< numbers up to this are zero
  int n = 0;             ///< how many independent ones there are
};
NullVectors null_vectors(int n_columns, int n_rows, const std::vector<Eigen::Triplet<double>>& Jt);

}  // namespace lockstep
