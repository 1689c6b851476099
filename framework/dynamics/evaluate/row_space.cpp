// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/evaluate/row_space.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include <Eigen/SparseCholesky>

#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"

namespace lockstep {

namespace {

VecX lengths_of_rows(const SparseMat& Jt) {
  VecX lengths(Jt.cols());
  for (Eigen::Index k = 0; k < Jt.cols(); ++k) {
    const double length = Jt.col(k).norm();
    if (!std::isfinite(length))
      throw NonFiniteError("a constraint is not finite; check the markers and laws of its joint", 0.0);
    lengths[k] = length > 0 ? length : 1;
  }
  return lengths;
}

// Dependencies are eigenvectors of J Jt of the value zero. J Jt - theta 1 = L D L^T has as many positive numbers in D as
// J Jt has values above theta (Sylvester's law of inertia). What theta (theta 1 - J Jt)^-1 leaves of a vector lies in the
// dependencies, and of a few vectors at random one has a share of every row that takes part.
void find_sparsely(const SparseMat& Jt, Dependencies& out) {
  constexpr double kTheta =
      1e-12;  // the square of a singular value, between round-off and a loop of some thousand rows
  constexpr int kVectors = 8;
  const VecX lengths = lengths_of_rows(Jt);
  const SparseMat J = scaled(VecX::Ones(Jt.rows()), Jt, lengths.cwiseInverse());
  SparseMat one(J.cols(), J.cols());
  one.setIdentity();
  const Eigen::SimplicialLDLT<SparseMat> ldlt(SparseMat(SparseMat(J.transpose()) * J) - kTheta * one);
  if (ldlt.info() != Eigen::Success)
    throw SolveError("the rank of the constraints cannot be computed: a pivot is zero");
  out.rank = static_cast<int>((ldlt.vectorD().array() > 0).count());
  out.circuits.resize(J.cols(), 0);
  if (out.rank == J.cols()) return;
  std::minstd_rand random(1);
  MatX left(J.cols(), kVectors);
  for (auto column : left.colwise()) {
    const VecX signs = VecX::NullaryExpr(J.cols(), [&] { return random() % 2 == 0 ? 1.0 : -1.0; });
    column = ldlt.solve(signs);
    column /= column.lpNorm<Eigen::Infinity>();
  }
  out.round_off = 10 * std::numeric_limits<double>::epsilon() / kTheta;  // of terms of size 1 over theta
  DependentRows& all = out.sets.emplace_back();
  all.too_many = static_cast<int>(J.cols()) - out.rank;
  for (int row = 0; row < J.cols(); ++row)
    if (left.row(row).lpNorm<Eigen::Infinity>() > out.round_off) all.rows.push_back(row);
  out.circuits = lengths.cwiseInverse().asDiagonal() * left;
}

}  // namespace

RowSpace::RowSpace(const SparseMat& Jt)
    : lengths_(lengths_of_rows(Jt)), qr_(MatX(Jt * lengths_.cwiseInverse().asDiagonal())) {}

double RowSpace::smallest_singular_value(int rank) const {
  const MatX R = qr_.R.topRows(rank).triangularView<Eigen::Upper>();
  return rank > 0 ? std::sqrt(std::max(0.0, symmetric_eigenvalues(R.lazyProduct(R.transpose()))[0])) : 1.0;
}

VecX RowSpace::free_part(const VecX& u) const {
  VecX free = u;
  apply_Qt(qr_.R, qr_.scale, free);
  free.head(rank()).setZero();
  apply_Q(qr_.R, qr_.scale, free);
  return free;
}

VecX RowSpace::circuit(int place, int regular) const {
  VecX x = VecX::Zero(n_rows());
  if (regular > 0) {
    VecX shares = qr_.R.col(place).head(regular);
    qr_.R.topLeftCorner(regular, regular).triangularView<Eigen::Upper>().solveInPlace(shares);
    for (int i = 0; i < regular; ++i) x[row_at(i)] = -shares[i];
  }
  x[row_at(place)] = 1;
  return x / x.lpNorm<Eigen::Infinity>();
}

MatX RowSpace::circuits(double limit) const {
  const int regular = rank(limit);
  MatX out(n_rows(), n_rows() - regular);
  for (int place = regular; place < n_rows(); ++place)
    out.col(place - regular) = circuit(place, regular).cwiseQuotient(lengths_);
  return out;
}

std::vector<DependentRows> RowSpace::sets() const {
  const int regular = rank(kNearlyDependent), exact = rank();
  Parts sets(n_rows());
  for (int place = regular; place < n_rows(); ++place) {
    const VecX shares = circuit(place, regular);
    for (int row = 0; row < n_rows(); ++row)
      if (std::abs(shares[row]) > kShare) join(sets, row, row_at(place));
  }
  std::map<int, DependentRows> found;  // by the set's number
  for (int place = regular; place < n_rows(); ++place) {
    DependentRows& set = found[sets.find_set(row_at(place))];
    if (place >= exact)
      ++set.too_many;
    else
      ++set.nearly, set.pivot = std::max(set.pivot, pivot(place));
  }
  for (int row = 0; row < n_rows(); ++row)
    if (const auto set = found.find(sets.find_set(row)); set != found.end()) set->second.rows.push_back(row);
  std::vector<DependentRows> out;
  for (auto& [number, set] : found) out.push_back(std::move(set));
  std::ranges::sort(out, {}, [](const DependentRows& s) { return s.rows.front(); });
  return out;
}

Dependencies::Dependencies(const SparseMat& Jt, double limit) {
  if (Jt.cols() > kDenseRows && limit <= kDependent) {
    find_sparsely(Jt, *this);
    return;
  }
  const RowSpace space(Jt);
  rank = space.rank(limit), sets = space.sets(), circuits = space.circuits(limit);
  round_off = std::max(kShare, 10 * limit);  // what is left of a row is spread over some others
}

}  // namespace lockstep
