#include "framework/dynamics/solvers/sparse_solver.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>

#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/params/params.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplet = Eigen::Triplet<double>;

constexpr double kEps = 1e-8;         // proximal term, relative
constexpr double kSmallPivot = 1e-6;  // counted as redundant or singular

// Order of elimination of the links: minimum degree on the graph whose edges are common slots.
std::vector<int> minimum_degree(const KktPattern& pattern) {
  const int n_links = static_cast<int>(pattern.links.size());
  std::vector<std::vector<int>> on_slot(pattern.width.size());
  for (int l = 0; l < n_links; ++l) {
    const KktLink& link = pattern.links[static_cast<std::size_t>(l)];
    for (int i = 0; i < link.n_slots; ++i)
      on_slot[static_cast<std::size_t>(link.slot[static_cast<std::size_t>(i)])].push_back(l);
  }
  std::vector<Triplet> edges;
  for (int l = 0; l < n_links; ++l) edges.emplace_back(l, l, 1.0);
  for (const std::vector<int>& links : on_slot)
    for (const int p : links)
      for (const int q : links) edges.emplace_back(p, q, 1.0);
  Sparse graph(n_links, n_links);
  graph.setFromTriplets(edges.begin(), edges.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  return {order.indices().data(), order.indices().data() + n_links};
}

// visit(row, column) for every number of K, upper triangle: the masses, the jacobians, the diagonal of E'.
template <class Visit>
void for_each_number(const KktPattern& pattern, const std::vector<int>& place, Visit&& visit) {
  for_each_mass(pattern, [&](int first, int width, std::size_t) {
    for (int i = 0; i < width; ++i)
      for (int k = i; k < width; ++k) visit(first + i, first + k);
  });
  for_each_jacobian(pattern, [&](const KktLink& link, int first, int width, std::size_t) {
    for (int j = link.first_row; j < link.first_row + link.m; ++j)
      for (int k = 0; k < width; ++k) visit(first + k, place[static_cast<std::size_t>(j)]);
  });
  for (const int p : place) visit(p, p);
}

}  // namespace

struct SparseSolver::Work {
  Sparse K;  // upper triangle, already in the order of elimination
  Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>> ldlt;
  std::vector<int> place;        // of a row of the system in K; unknowns keep theirs
  std::vector<Eigen::Index> at;  // places in the values of K, in the order of for_each_number
  VecX rhs, x, S_diagonal;
  StopRule rule;
  int n_small = 0, n_small_usual = 0;
  double smallest_pivot = 0.0;

  void order_rows(const KktPattern&);
  void shape(const KktPattern&);
  Eigen::Index position(int row, int column) const;
  void measure_pivots(const Kkt&);
};

void SparseSolver::Work::order_rows(const KktPattern& pattern) {
  place.assign(static_cast<std::size_t>(pattern.m), 0);
  int next = pattern.n;
  if (pattern.links.empty()) return;
  for (const int l : minimum_degree(pattern)) {
    const KktLink& link = pattern.links[static_cast<std::size_t>(l)];
    for (int k = 0; k < link.m; ++k) place[static_cast<std::size_t>(link.first_row + k)] = next++;
  }
}

void SparseSolver::Work::shape(const KktPattern& pattern) {
  std::vector<Triplet> numbers;
  for_each_number(pattern, place, [&](int row, int column) { numbers.emplace_back(row, column, 1.0); });
  K.resize(pattern.n + pattern.m, pattern.n + pattern.m);
  K.setFromTriplets(numbers.begin(), numbers.end());
  K.makeCompressed();
  at.clear();
  for_each_number(pattern, place, [&](int row, int column) { at.push_back(position(row, column)); });
}

// Where K(row, column) stands among K's values.
Eigen::Index SparseSolver::Work::position(int row, int column) const {
  const int* begin = K.innerIndexPtr() + K.outerIndexPtr()[column];
  const int* end = K.innerIndexPtr() + K.outerIndexPtr()[column + 1];
  return std::lower_bound(begin, end, row) - K.innerIndexPtr();
}

void SparseSolver::Work::measure_pivots(const Kkt& kkt) {
  row_diagonal(kkt, S_diagonal);
  smallest_pivot = std::numeric_limits<double>::infinity();
  n_small = 0;
  const VecX D = ldlt.vectorD();
  for (int j = 0; j < kkt.pattern.m; ++j) {
    const double pivot = -D[place[static_cast<std::size_t>(j)]];
    smallest_pivot = std::min(smallest_pivot, pivot / (S_diagonal[j] + kEps * kkt.E[j]));
    if (pivot < kSmallPivot * std::max(S_diagonal[j], kkt.E[j])) ++n_small;
  }
  n_small_usual = std::min(n_small_usual, n_small);
}

SparseSolver::SparseSolver() : work_(std::make_unique<Work>()) {}
SparseSolver::~SparseSolver() = default;

TypeInfo SparseSolver::info() {
  return {"sparse", "sparse LDL^T with proximal corrections: any topology, redundant rows in their stride", {}};
}
std::unique_ptr<LinearSolver> SparseSolver::make(const Params&) { return std::make_unique<SparseSolver>(); }

void SparseSolver::analyse(const KktPattern& pattern) {
  Work& w = *work_;
  w.order_rows(pattern);
  w.shape(pattern);
  w.ldlt.analyzePattern(w.K);
  for (VecX* v : {&w.rhs, &w.x}) v->setZero(pattern.n + pattern.m);
  w.S_diagonal.setZero(pattern.m);
  w.rule.analyse(pattern);
  w.n_small_usual = pattern.m;
}

void SparseSolver::factor(const Kkt& kkt) {
  Work& w = *work_;
  double* K = w.K.valuePtr();
  const Eigen::Index* at = w.at.data();
  for_each_mass(kkt.pattern, [&](int, int width, std::size_t block) {
    for (int i = 0; i < width; ++i)
      for (int k = i; k < width; ++k) K[*at++] = kkt.M[block + static_cast<std::size_t>(i * width + k)];
  });
  for_each_jacobian(kkt.pattern, [&](const KktLink& link, int, int width, std::size_t block) {
    for (int i = 0; i < link.m * width; ++i) K[*at++] = kkt.J[block + static_cast<std::size_t>(i)];
  });
  for (int j = 0; j < kkt.pattern.m; ++j) K[*at++] = -kEps * kkt.E[j];
  w.ldlt.factorize(w.K);
  if (w.ldlt.info() != Eigen::Success)
    throw SolveError("solver sparse: a pivot is zero; give every body a mass and an inertia above zero");
  w.measure_pivots(kkt);
}

SolveReport SparseSolver::solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  Work& w = *work_;
  const int n = kkt.pattern.n, m = kkt.pattern.m;
  SolveReport report;
  w.rule.iterate(kkt, f, c, a, lambda, report, [&](VecX& x, VecX& l) {
    w.rhs.head(n) = w.rule.force_residual();
    for (int j = 0; j < m; ++j) w.rhs[w.place[static_cast<std::size_t>(j)]] = w.rule.row_residual()[j];
    w.x = w.ldlt.solve(w.rhs);
    x += w.x.head(n);
    for (int j = 0; j < m; ++j) l[j] += w.x[w.place[static_cast<std::size_t>(j)]];
  });
  report.smallest_pivot = w.smallest_pivot;
  // Contradictory rows are dependent always; a small pivot beyond the usual ones tells a singular place, to be passed.
  report.contradictory = w.rule.largest() > kContradiction && w.rule.stalled() && w.n_small <= w.n_small_usual;
  return report;
}

}  // namespace lockstep
