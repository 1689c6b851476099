#include "framework/dynamics/solvers/block_solver.h"

#include <algorithm>
#include <limits>

#include "framework/dynamics/solvers/block_factor.h"
#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/foundation/support/error.h"
#include "framework/mechanism/params/params.h"

namespace lockstep {

namespace {

BlockGraph graph_of(const KktPattern& pattern) {
  BlockGraph graph;
  graph.n_slots = static_cast<int>(pattern.width.size());
  graph.width = pattern.width;
  graph.first = pattern.first;
  for (const KktLink& link : pattern.links) {
    const int node = static_cast<int>(graph.width.size());
    graph.width.push_back(link.m);
    graph.first.push_back(pattern.n + link.first_row);
    for (int i = 0; i < link.n_slots; ++i) graph.edges.emplace_back(link.slot[i], node);
  }
  return graph;
}

}  // namespace

class BlockFactorization final : public Factorization {
 public:
  explicit BlockFactorization(const KktPattern&);
  void compute(const Kkt&) override;
  SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override;
  void complete(SolveReport&) override;

 private:
  BlockPlan plan;
  BlockFactor<double> factor;
  std::vector<BlockPlan::Place> mass, jacobian, proximal;  // of slots; of links and their slots; of links
  VecX rhs, pivots;
  std::vector<double> relative, scratch;  // pivots of the rows against their scales
  StopRule rule;
  PivotWatch watch;
  double smallest_pivot = 0.0;

  void fill(const Kkt&);
  void measure_pivots(const Kkt&);
};

void BlockFactorization::fill(const Kkt& kkt) {
  const KktPattern& pattern = kkt.pattern;
  factor.clear();
  const BlockPlan::Place* place = mass.data();
  for_each_mass(pattern, [&](int, int width, std::size_t at) {
    std::copy_n(kkt.M.data() + at, width * width, factor.at(place++->at));
  });
  place = jacobian.data();
  for_each_jacobian(pattern, [&](const KktLink& link, int, int width, std::size_t at) {
    const double* J = kkt.J.data() + at;
    double* out = factor.at(place->at);
    if (!place++->transposed) {
      std::copy_n(J, link.m * width, out);
      return;
    }
    for (int j = 0; j < link.m; ++j)
      for (int k = 0; k < width; ++k) out[k * link.m + j] = J[j * width + k];
  });
  place = proximal.data();
  for (const KktLink& link : pattern.links) {
    double* out = factor.at(place++->at);
    for (int j = 0; j < link.m; ++j) out[j * (link.m + 1)] = -plan.proximal() * kkt.E[link.first_row + j];
  }
}

void BlockFactorization::measure_pivots(const Kkt& kkt) {
  smallest_pivot = std::numeric_limits<double>::infinity();
  int n_small = 0;
  for (int j = 0; j < kkt.pattern.m; ++j) {
    const double pivot = relative[j] = pivots[kkt.pattern.n + j] / kkt.E[j];
    smallest_pivot = std::min(smallest_pivot, pivot);
    if (pivot < kSmallPivot) ++n_small;
  }
  watch.count(n_small);
}

TypeInfo BlockSolver::info() {
  return {
      "block", "LDL^T in blocks over slots and links, leaves first: linear on trees, redundant rows in its stride", {}};
}
std::unique_ptr<LinearSolver> BlockSolver::make(const Params&) { return std::make_unique<BlockSolver>(); }

BlockFactorization::BlockFactorization(const KktPattern& pattern) {
  plan.lay_out(graph_of(pattern), true);
  factor.lay_out(plan);
  const int n_slots = static_cast<int>(pattern.width.size());
  for (int k = 0; k < n_slots; ++k) mass.push_back(plan.find(k, k));
  int node = n_slots;
  for (const KktLink& link : pattern.links) {
    for (int i = 0; i < link.n_slots; ++i) jacobian.push_back(plan.find(node, link.slot[i]));
    proximal.push_back(plan.find(node, node));
    ++node;
  }
  for (VecX* v : {&rhs, &pivots}) v->setZero(pattern.n + pattern.m);
  relative.assign(static_cast<std::size_t>(pattern.m), 0.0);
  scratch = relative;
  rule.analyse(pattern);
  watch.begin(pattern.m);
}

void BlockFactorization::compute(const Kkt& kkt) {
  fill(kkt);
  if (!factor.factor_symmetric(plan, pivots.data()))
    throw SolveError("solver block: a pivot is zero; give every body a mass and an inertia above zero");
  measure_pivots(kkt);
}

SolveReport BlockFactorization::solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  const int n = kkt.pattern.n, m = kkt.pattern.m;
  SolveReport report;
  rule.iterate(kkt, f, c, a, lambda, report, [&](VecX& x, VecX& l) {
    rhs.head(n) = rule.force_residual();
    rhs.tail(m) = rule.row_residual();
    factor.solve(plan, rhs.data());
    x += rhs.head(n);
    l += rhs.tail(m);
  });
  report.smallest_pivot = smallest_pivot;
  report.contradictory = watch.contradictory(rule.largest(), rule.largest_before());
  return report;
}

void BlockFactorization::complete(SolveReport& report) {
  scratch = relative;
  report.detector = watch.singularity_indicator(scratch);
}

long BlockSolver::multiplications(const KktPattern& pattern) {
  BlockPlan plan;
  plan.lay_out(graph_of(pattern), true);
  return plan.multiplications;
}

std::unique_ptr<Factorization> BlockSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<BlockFactorization>(pattern);
}

}  // namespace lockstep
