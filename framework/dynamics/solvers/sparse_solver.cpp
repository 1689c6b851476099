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

class SparseFactorization final : public Factorization {
 public:
  explicit SparseFactorization(const KktPattern&);
  void compute(const Kkt&) override;
  SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override;

 private:
  Sparse matrix;  // upper triangle, already in the order of elimination
  Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>> ldlt;
  std::vector<int> place;        // of a row of the system in K; unknowns keep theirs
  std::vector<Eigen::Index> positions;  // places in the values of K, in the order of for_each_number
  VecX rhs, solution, S_diagonal;
  StopRule rule;
  int n_small = 0, n_small_usual = 0;
  double smallest_pivot = 0.0;

  void order_rows(const KktPattern&);
  void shape(const KktPattern&);
  Eigen::Index position(int row, int column) const;
  void measure_pivots(const Kkt&);
};

void SparseFactorization::order_rows(const KktPattern& pattern) {
  place.assign(static_cast<std::size_t>(pattern.m), 0);
  int next = pattern.n;
  if (pattern.links.empty()) return;
  for (const int l : minimum_degree(pattern)) {
    const KktLink& link = pattern.links[static_cast<std::size_t>(l)];
    for (int k = 0; k < link.m; ++k) place[static_cast<std::size_t>(link.first_row + k)] = next++;
  }
}

void SparseFactorization::shape(const KktPattern& pattern) {
  std::vector<Triplet> numbers;
  for_each_number(pattern, place, [&](int row, int column) { numbers.emplace_back(row, column, 1.0); });
  matrix.resize(pattern.n + pattern.m, pattern.n + pattern.m);
  matrix.setFromTriplets(numbers.begin(), numbers.end());
  matrix.makeCompressed();
  positions.clear();
  for_each_number(pattern, place, [&](int row, int column) { positions.push_back(position(row, column)); });
}

// Where K(row, column) stands among K's values.
Eigen::Index SparseFactorization::position(int row, int column) const {
  const int* begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column];
  const int* end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[column + 1];
  return std::lower_bound(begin, end, row) - matrix.innerIndexPtr();
}

void SparseFactorization::measure_pivots(const Kkt& kkt) {
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

TypeInfo SparseSolver::info() {
  return {"sparse", "sparse LDL^T with proximal corrections: any topology, redundant rows in their stride", {}};
}
std::unique_ptr<LinearSolver> SparseSolver::make(const Params&) { return std::make_unique<SparseSolver>(); }

SparseFactorization::SparseFactorization(const KktPattern& pattern) {
  order_rows(pattern);
  shape(pattern);
  ldlt.analyzePattern(matrix);
  for (VecX* v : {&rhs, &solution}) v->setZero(pattern.n + pattern.m);
  S_diagonal.setZero(pattern.m);
  rule.analyse(pattern);
  n_small_usual = pattern.m;
}

void SparseFactorization::compute(const Kkt& kkt) {
  double* K = matrix.valuePtr();
  const Eigen::Index* at = positions.data();
  for_each_mass(kkt.pattern, [&](int, int width, std::size_t block) {
    for (int i = 0; i < width; ++i)
      for (int k = i; k < width; ++k) K[*at++] = kkt.M[block + static_cast<std::size_t>(i * width + k)];
  });
  for_each_jacobian(kkt.pattern, [&](const KktLink& link, int, int width, std::size_t block) {
    for (int i = 0; i < link.m * width; ++i) K[*at++] = kkt.J[block + static_cast<std::size_t>(i)];
  });
  for (int j = 0; j < kkt.pattern.m; ++j) K[*at++] = -kEps * kkt.E[j];
  ldlt.factorize(matrix);
  if (ldlt.info() != Eigen::Success)
    throw SolveError("solver sparse: a pivot is zero; give every body a mass and an inertia above zero");
  measure_pivots(kkt);
}

SolveReport SparseFactorization::solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  const int n = kkt.pattern.n, m = kkt.pattern.m;
  SolveReport report;
  rule.iterate(kkt, f, c, a, lambda, report, [&](VecX& x, VecX& l) {
    rhs.head(n) = rule.force_residual();
    for (int j = 0; j < m; ++j) rhs[place[static_cast<std::size_t>(j)]] = rule.row_residual()[j];
    solution = ldlt.solve(rhs);
    x += solution.head(n);
    for (int j = 0; j < m; ++j) l[j] += solution[place[static_cast<std::size_t>(j)]];
  });
  report.smallest_pivot = smallest_pivot;
  // Contradictory rows are dependent always; a small pivot beyond the usual ones tells a singular place, to be passed.
  report.contradictory = rule.largest() > kContradiction && rule.stalled() && n_small <= n_small_usual;
  return report;
}

std::unique_ptr<Factorization> SparseSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<SparseFactorization>(pattern);
}

}  // namespace lockstep
