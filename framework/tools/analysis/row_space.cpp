#include "framework/tools/analysis/row_space.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace lockstep {

namespace {

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

}  // namespace

RowSpace::RowSpace(MatX Jt) : n_(Jt.rows()), lengths_(Jt.colwise().norm()) {
  for (double& length : lengths_)
    if (!(length > 0)) length = 1;
  for (Eigen::Index k = 0; k < Jt.cols(); ++k) Jt.col(k) /= lengths_[k];
  if (Jt.size() > 0) qr_.compute(Jt);
}

double RowSpace::pivot(int place) const {
  return place < std::min(qr_.rows(), qr_.cols()) ? std::abs(qr_.matrixR()(place, place)) : 0.0;
}

int RowSpace::above(double limit) const {
  int n = 0;
  while (pivot(n) > limit) ++n;
  return n;
}

MatX RowSpace::free() const {
  MatX N = MatX::Identity(n_, n_).rightCols(n_ - rank());
  if (qr_.rows() > 0) N.applyOnTheLeft(qr_.householderQ());
  return N;
}

MatX RowSpace::shares(int regular) const {
  const auto R1 = qr_.matrixR().topLeftCorner(regular, regular).triangularView<Eigen::Upper>();
  MatX x = qr_.matrixR().topRightCorner(regular, n_rows() - regular);
  if (regular > 0) R1.solveInPlace(x);
  return x;
}

MatX RowSpace::circuits(double limit) const {
  const int regular = above(limit), left = n_rows() - regular;
  if (qr_.rows() == 0) return MatX::Identity(left, left);
  MatX pivoted = MatX::Identity(n_rows(), n_rows()).rightCols(left);
  if (left == 0) return pivoted;
  pivoted.topRows(regular) = -shares(regular);
  return lengths_.cwiseInverse().asDiagonal() * MatX(qr_.colsPermutation() * pivoted);
}

std::vector<DependentRows> RowSpace::sets() const {
  const int regular = above(kNearlyDependent), exact = rank();
  std::vector<DependentRows> out;
  if (qr_.rows() == 0)  // they touch nothing that moves
    for (int row = 0; row < n_rows(); ++row) out.push_back({{row}, 1});
  if (regular == n_rows() || qr_.rows() == 0) return out;
  const MatX x = shares(regular);
  Sets sets(n_rows());
  for (int j = regular; j < n_rows(); ++j) {
    const auto column = x.col(j - regular);
    const double least = kShare * std::max(1.0, regular > 0 ? column.lpNorm<Eigen::Infinity>() : 0.0);
    for (int i = 0; i < regular; ++i)
      if (std::abs(column[i]) > least) sets.join(row_at(i), row_at(j));
  }
  std::map<int, DependentRows> found;  // by the set's number
  for (int j = regular; j < n_rows(); ++j) {
    DependentRows& set = found[sets.of(row_at(j))];
    if (j >= exact)
      ++set.too_many;
    else
      ++set.nearly, set.pivot = std::max(set.pivot, pivot(j));
  }
  for (int row = 0; row < n_rows(); ++row)
    if (const auto set = found.find(sets.of(row)); set != found.end()) set->second.rows.push_back(row);
  for (auto& [number, set] : found) out.push_back(std::move(set));
  std::ranges::sort(out, {}, [](const DependentRows& s) { return s.rows.front(); });
  return out;
}

}  // namespace lockstep
