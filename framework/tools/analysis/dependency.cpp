#include "framework/tools/analysis/dependency.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/SparseCholesky>

#include <lockstep/error.h>

namespace lockstep {

namespace {

constexpr int kDense = 300;  // rows up to which the decomposition is dense

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

Inertia inertia_of(const LoopRows& rows) {
  constexpr double kEps = 1e-13;
  constexpr int kVectors = 8;
  Sparse Jt(rows.n_columns(), rows.n());
  Jt.setFromTriplets(rows.Jt().begin(), rows.Jt().end());
  const Sparse S = Jt.transpose() * Jt;
  Inertia out;
  Eigen::SimplicialLDLT<Sparse> ldlt(shifted(S, -kTheta));
  if (ldlt.info() != Eigen::Success) throw SolveError("the rank of the rows could not be found: a pivot is zero");
  out.rank = static_cast<int>((ldlt.vectorD().array() > 0).count());
  if (out.rank == rows.n()) return out;
  ldlt.factorize(shifted(S, kEps));
  std::minstd_rand random(1);
  out.left.resize(S.rows(), kVectors);
  for (int k = 0; k < kVectors; ++k) {
    const VecX signs = VecX::NullaryExpr(S.rows(), [&] { return random() % 2 == 0 ? 1.0 : -1.0; });
    out.left.col(k) = kEps * ldlt.solve(signs);
  }
  return out;
}

Dependencies by_inertia(const LoopRows& rows) {
  const Inertia inertia = inertia_of(rows);
  Dependencies out;
  out.rank = inertia.rank;
  if (out.rank == rows.n()) return out;
  const VecX left = inertia.left.cwiseAbs().rowwise().maxCoeff();
  DependentRows all;
  all.too_many = rows.n() - out.rank;
  const double least = kTakesPart * left.maxCoeff();
  for (int row = 0; row < rows.n(); ++row)
    if (left[row] > least) all.rows.push_back(row);
  out.sets.push_back(std::move(all));
  return out;
}

void refuse_not_finite(const LoopRows& rows) {
  for (const auto& t : rows.Jt())
    if (!std::isfinite(t.value())) throw NonFiniteError("a row is not finite, so that its rank is none", 0.0);
}

}  // namespace

NullVectors null_vectors(const LoopRows& rows, double pivot) {
  refuse_not_finite(rows);
  NullVectors found;
  if (rows.n() <= kDense || pivot > kDependent) {
    found = {RowSpace(rows.matrix()).circuits(pivot), std::max(kShare, 10 * pivot)};
    found.n = static_cast<int>(found.columns.cols());
  } else if (Inertia inertia = inertia_of(rows); inertia.rank == rows.n()) {
    found.columns = MatX(rows.n(), 0);
  } else {
    found = {std::move(inertia.left), kTakesPart, rows.n() - inertia.rank};
  }
  for (auto column : found.columns.colwise()) column /= column.cwiseAbs().maxCoeff();
  return found;
}

Dependencies find_dependencies(const LoopRows& rows) {
  refuse_not_finite(rows);
  if (rows.n() > kDense) return by_inertia(rows);
  const RowSpace space(rows.matrix());
  return {space.rank(), space.sets()};
}

}  // namespace lockstep
