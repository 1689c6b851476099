// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

// Where the rows are in K, in the order in which the links are eliminated; those that share a slot are coupled.
std::vector<int> places_of_rows(const KktPattern& pattern) {
  LinkGraph graph;
  graph.n_slots = pattern.n_slots();
  for (const KktLink& link : pattern.links)
    graph.slots.emplace_back(link.slot.begin(), link.slot.begin() + link.n_slots);
  Neighbours neighbours(pattern.links.size());
  for (const std::vector<int>& links : graph.links_of_slots())
    for (const int p : links)
      for (const int q : links) couple(neighbours, p, q);
  MinimumDegree order(std::move(neighbours), std::vector<int>(pattern.links.size(), 1));
  std::vector<int> places(pattern.m);
  for (int next = pattern.n; !order.done();) {
    const KktLink& link = pattern.links[order.next().node];
    for (int k = 0; k < link.m; ++k) places[link.first_row + k] = next++;
  }
  return places;
}

// visit(row, column) for every number of K, upper triangle: the masses, the Jacobians, the diagonal of E'.
template <class Visit>
void for_each_number(const KktPattern& pattern, const std::vector<int>& place, Visit&& visit) {
  for_each_mass(pattern, [&](int first, int width, std::size_t) {
    for (int i = 0; i < width; ++i)
      for (int k = i; k < width; ++k) visit(first + i, first + k);
  });
  for_each_jacobian(pattern, [&](const KktLink& link, int first, int width, std::size_t) {
    for (int j = link.first_row; j < link.first_row + link.m; ++j)
      for (int k = 0; k < width; ++k) visit(first + k, place[j]);
  });
  for (const int p : place) visit(p, p);
}

}  // namespace

class SparseFactorization final : public Factorization {
 public:
  explicit SparseFactorization(const KktPattern& pattern) : place_(places_of_rows(pattern)) {
    shape(pattern);
    ldlt_.analyzePattern(matrix_);
    for (VecX* v : {&rhs_, &solution_}) v->setZero(pattern.n + pattern.m);
    rule_.analyse(pattern, kProximalOfMatrix);
    watch_.begin(pattern.m);
  }

  void compute(const Kkt& kkt) override {
    double* K = matrix_.valuePtr();
    const Eigen::Index* at = positions_.data();
    for_each_mass(kkt.pattern, [&](int, int width, std::size_t block) {
      for (int i = 0; i < width; ++i)
        for (int k = i; k < width; ++k) K[*at++] = kkt.M[block + i * width + k];
    });
    for_each_jacobian(kkt.pattern, [&](const KktLink& link, int, int width, std::size_t block) {
      for (int i = 0; i < link.m * width; ++i) K[*at++] = kkt.J[block + i];
    });
    for (int j = 0; j < kkt.pattern.m; ++j) K[*at++] = -kProximalOfMatrix * kkt.E[j];
    ldlt_.factorize(matrix_);
    if (ldlt_.info() != Eigen::Success)
      throw SolveError("solver sparse: a pivot is zero; give every body a mass and an inertia above zero");
    const VecX D = ldlt_.vectorD();
    rule_.show_pivots(kkt, watch_, [&](int j) { return -D[place_[j]]; });
  }

  SolveReport solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
    const int n = kkt.pattern.n, m = kkt.pattern.m;
    return rule_.iterate(kkt, f, c, a, lambda, watch_, [&](const VecX& r_f, const VecX& r_c, VecX& da, VecX& dl) {
      rhs_.head(n) = r_f;
      for (int j = 0; j < m; ++j) rhs_[place_[j]] = r_c[j];
      solution_ = ldlt_.solve(rhs_);
      da = solution_.head(n);
      for (int j = 0; j < m; ++j) dl[j] = solution_[place_[j]];
    });
  }

  void complete(SolveReport& report) override { watch_.report(report); }

 private:
  Sparse matrix_;  // upper triangle, already in the order of elimination
  Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>> ldlt_;
  std::vector<int> place_;               // of a row of the system in K; unknowns keep theirs
  std::vector<Eigen::Index> positions_;  // places in the values of K, in the order of for_each_number
  VecX rhs_, solution_;
  StopRule rule_;
  PivotWatch watch_;

  void shape(const KktPattern& pattern) {
    std::vector<Triplet> numbers;
    for_each_number(pattern, place_, [&](int row, int column) { numbers.emplace_back(row, column, 1.0); });
    matrix_.resize(pattern.n + pattern.m, pattern.n + pattern.m);
    matrix_.setFromTriplets(numbers.begin(), numbers.end());
    matrix_.makeCompressed();
    positions_.clear();
    for_each_number(pattern, place_, [&](int row, int column) { positions_.push_back(position(row, column)); });
  }

  // The index of K(row, column) among K's values.
  Eigen::Index position(int row, int column) const {
    const int* begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column];
    const int* end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[column + 1];
    return std::lower_bound(begin, end, row) - matrix_.innerIndexPtr();
  }
};

TypeInfo SparseSolver::info() {
  return {"sparse", "sparse LDL^T with proximal corrections: any topology, handles redundant constraints", {}};
}
std::unique_ptr<LinearSolver> SparseSolver::make(const Params&) { return std::make_unique<SparseSolver>(); }

std::unique_ptr<Factorization> SparseSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<SparseFactorization>(pattern);
}

}  // namespace lockstep
