#include "framework/tools/analysis/dependency.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>

#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include <lockstep/error.h>

namespace lockstep {

namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr int kDense = 300;      // rows up to which the decomposition is dense
constexpr double kShare = 1e-7;  // of a circuit: a row with less takes no part

// Sets of rows that circuits connect.
class Sets {
 public:
  explicit Sets(int n) : parent_(static_cast<std::size_t>(n)) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int i) {
    for (int& p = at(i); p != at(p); p = at(p)) at(i) = at(p);
    return at(i);
  }
  void join(int i, int j) { at(of(i)) = of(j); }

 private:
  int& at(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

// Jt P = Q [R1 R2; 0 0], R1 upper triangular, the largest pivot first. Column j of -R1^-1 R2 with a one at j is a circuit:
// a combination of rows that is zero.
MatX dense(int n_columns, int n_rows, const Triplets& Jt) {
  MatX A = MatX::Zero(n_columns, n_rows);
  for (const auto& t : Jt) A(t.row(), t.col()) += t.value();
  return A;
}

Dependencies by_circuits(int n_columns, int n_rows, const Triplets& Jt) {
  const Eigen::ColPivHouseholderQR<MatX> qr(dense(n_columns, n_rows, Jt));
  const auto row_at = [&](int place) { return static_cast<int>(qr.colsPermutation().indices()[place]); };
  const int n_pivots = std::min(n_columns, n_rows);
  const auto pivot = [&](int place) { return place < n_pivots ? std::abs(qr.matrixR()(place, place)) : 0.0; };
  const auto above = [&](double limit) {
    int n = 0;
    while (n < n_pivots && pivot(n) > limit) ++n;
    return n;
  };
  Dependencies out;
  out.rank = above(kDependent);
  const int regular = above(kNearlyDependent);

  Sets sets(n_rows);
  const auto R1 = qr.matrixR().topLeftCorner(regular, regular).triangularView<Eigen::Upper>();
  for (int j = regular; j < n_rows; ++j) {
    VecX x = qr.matrixR().col(j).head(regular);
    R1.solveInPlace(x);
    const double least = kShare * std::max(1.0, regular > 0 ? x.lpNorm<Eigen::Infinity>() : 0.0);
    for (int i = 0; i < regular; ++i)
      if (std::abs(x[i]) > least) sets.join(row_at(i), row_at(j));
  }
  std::map<int, DependentRows> found;  // by the set's number
  for (int j = regular; j < n_rows; ++j) {
    DependentRows& set = found[sets.of(row_at(j))];
    if (j >= out.rank) {
      ++set.too_many;
    } else {
      ++set.nearly;
      set.pivot = std::max(set.pivot, pivot(j));
    }
  }
  for (int row = 0; row < n_rows; ++row)
    if (const auto set = found.find(sets.of(row)); set != found.end()) set->second.rows.push_back(row);
  for (auto& [number, set] : found) out.sets.push_back(std::move(set));
  std::ranges::sort(out.sets, {}, [](const DependentRows& s) { return s.rows.front(); });
  return out;
}

using Sparse = Eigen::SparseMatrix<double>;

Sparse shifted(const Sparse& S, double by) {
  Sparse one(S.rows(), S.cols());
  one.setIdentity();
  return S + by * one;
}

// Dependencies are eigenvectors of J Jt of the value zero. J Jt - theta 1 = L D L^T has as many negative numbers in D as
// J Jt has values below theta (Sylvester's law of inertia). What eps (J Jt + eps 1)^-1 leaves of a vector lies in the
// dependencies, and of a few vectors at random one has a share of every row that takes part.
constexpr double kTheta = 1e-12, kTakesPart = 1e-3;

struct Inertia {
  int rank = 0;
  MatX left;  // of a few vectors at random; empty where no row depends on others
};

Inertia inertia_of(int n_columns, int n_rows, const Triplets& triplets) {
  constexpr double kEps = 1e-13;
  constexpr int kVectors = 8;
  Sparse Jt(n_columns, n_rows);
  Jt.setFromTriplets(triplets.begin(), triplets.end());
  const Sparse S = Jt.transpose() * Jt;
  Inertia out;
  Eigen::SimplicialLDLT<Sparse> ldlt(shifted(S, -kTheta));
  if (ldlt.info() != Eigen::Success) throw SolveError("the rank of the rows could not be found: a pivot is zero");
  out.rank = static_cast<int>((ldlt.vectorD().array() > 0).count());
  if (out.rank == n_rows) return out;
  ldlt.factorize(shifted(S, kEps));
  std::minstd_rand random(1);
  out.left.resize(S.rows(), kVectors);
  for (int k = 0; k < kVectors; ++k) {
    const VecX signs = VecX::NullaryExpr(S.rows(), [&] { return random() % 2 == 0 ? 1.0 : -1.0; });
    out.left.col(k) = kEps * ldlt.solve(signs);
  }
  return out;
}

Dependencies by_inertia(int n_columns, int n_rows, const Triplets& triplets) {
  const Inertia inertia = inertia_of(n_columns, n_rows, triplets);
  Dependencies out;
  out.rank = inertia.rank;
  if (out.rank == n_rows) return out;
  const VecX left = inertia.left.cwiseAbs().rowwise().maxCoeff();
  DependentRows all;
  all.too_many = n_rows - out.rank;
  const double least = kTakesPart * left.maxCoeff();
  for (int row = 0; row < n_rows; ++row)
    if (left[row] > least) all.rows.push_back(row);
  out.sets.push_back(std::move(all));
  return out;
}

// Columns [-R1^-1 R2; 1], in the order of the rows.
MatX circuits(int n_columns, int n_rows, const Triplets& Jt) {
  const Eigen::ColPivHouseholderQR<MatX> qr(dense(n_columns, n_rows, Jt));
  int rank = 0;
  while (rank < std::min(n_columns, n_rows) && std::abs(qr.matrixR()(rank, rank)) > kDependent) ++rank;
  const int left = n_rows - rank;
  if (left == 0) return MatX(n_rows, 0);
  MatX pivoted = MatX::Identity(n_rows, n_rows).rightCols(left);
  pivoted.topRows(rank) = -qr.matrixR().topRightCorner(rank, left);
  const auto R1 = qr.matrixR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>();
  if (rank > 0 && left > 0) pivoted.topRows(rank) = R1.solve(MatX(pivoted.topRows(rank)));
  return qr.colsPermutation() * pivoted;
}

void refuse_not_finite(const Triplets& Jt) {
  for (const auto& t : Jt)
    if (!std::isfinite(t.value())) throw NonFiniteError("a row is not finite, so that its rank is none", 0.0);
}

}  // namespace

NullVectors null_vectors(int n_columns, int n_rows, const Triplets& Jt) {
  refuse_not_finite(Jt);
  NullVectors found;
  if (n_rows <= kDense) {
    found = {circuits(n_columns, n_rows, Jt), kShare};
    found.n = static_cast<int>(found.columns.cols());
  } else if (Inertia inertia = inertia_of(n_columns, n_rows, Jt); inertia.rank == n_rows) {
    found.columns = MatX(n_rows, 0);
  } else {
    found = {std::move(inertia.left), kTakesPart, n_rows - inertia.rank};
  }
  for (auto column : found.columns.colwise()) column /= column.cwiseAbs().maxCoeff();
  return found;
}

Dependencies find_dependencies(int n_columns, int n_rows, const Triplets& Jt) {
  refuse_not_finite(Jt);
  return n_rows <= kDense ? by_circuits(n_columns, n_rows, Jt) : by_inertia(n_columns, n_rows, Jt);
}

}  // namespace lockstep
