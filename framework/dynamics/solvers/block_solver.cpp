#include "framework/dynamics/solvers/block_solver.h"

#include <algorithm>
#include <limits>

#include "framework/dynamics/solvers/block_factor.h"
#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/params/params.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

namespace {

constexpr double kSmallPivot = 1e-6;  // counted as redundant or singular

BlockGraph graph_of(const KktPattern& pattern) {
  BlockGraph graph;
  graph.n_slots = static_cast<int>(pattern.width.size());
  graph.width = pattern.width;
  graph.first = pattern.first;
  for (const KktLink& link : pattern.links) {
    const int node = static_cast<int>(graph.width.size());
    graph.width.push_back(link.m);
    graph.first.push_back(pattern.n + link.first_row);
    for (int i = 0; i < link.n_slots; ++i) graph.edges.emplace_back(link.slot[static_cast<std::size_t>(i)], node);
  }
  return graph;
}

}  // namespace

struct BlockSolver::Work {
  BlockPlan plan;
  BlockFactor<double> factor;
  std::vector<BlockPlan::Place> mass, jacobian, proximal;  // of slots; of links and their slots; of links
  VecX rhs, pivots;
  std::vector<double> relative, scratch;  // pivots of the rows against their scales
  StopRule rule;
  int n_small = 0, n_small_usual = 0;
  double smallest_pivot = 0.0;

  void fill(const Kkt&);
  void measure_pivots(const Kkt&);
};

void BlockSolver::Work::fill(const Kkt& kkt) {
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

void BlockSolver::Work::measure_pivots(const Kkt& kkt) {
  smallest_pivot = std::numeric_limits<double>::infinity();
  n_small = 0;
  for (int j = 0; j < kkt.pattern.m; ++j) {
    const double pivot = relative[static_cast<std::size_t>(j)] = pivots[kkt.pattern.n + j] / kkt.E[j];
    smallest_pivot = std::min(smallest_pivot, pivot);
    if (pivot < kSmallPivot) ++n_small;
  }
  n_small_usual = std::min(n_small_usual, n_small);
}

BlockSolver::BlockSolver() : work_(std::make_unique<Work>()) {}
BlockSolver::~BlockSolver() = default;

TypeInfo BlockSolver::info() {
  return {
      "block", "LDL^T in blocks over slots and links, leaves first: linear on trees, redundant rows in its stride", {}};
}
std::unique_ptr<LinearSolver> BlockSolver::make(const Params&) { return std::make_unique<BlockSolver>(); }

void BlockSolver::analyse(const KktPattern& pattern) {
  Work& w = *work_;
  w.plan.lay_out(graph_of(pattern), true);
  w.factor.lay_out(w.plan);
  w.mass.clear(), w.jacobian.clear(), w.proximal.clear();
  const int n_slots = static_cast<int>(pattern.width.size());
  for (int k = 0; k < n_slots; ++k) w.mass.push_back(w.plan.find(k, k));
  int node = n_slots;
  for (const KktLink& link : pattern.links) {
    for (int i = 0; i < link.n_slots; ++i)
      w.jacobian.push_back(w.plan.find(node, link.slot[static_cast<std::size_t>(i)]));
    w.proximal.push_back(w.plan.find(node, node));
    ++node;
  }
  for (VecX* v : {&w.rhs, &w.pivots}) v->setZero(pattern.n + pattern.m);
  w.relative.assign(static_cast<std::size_t>(pattern.m), 0.0);
  w.scratch = w.relative;
  w.rule.analyse(pattern);
  w.n_small_usual = pattern.m;
}

void BlockSolver::factor(const Kkt& kkt) {
  Work& w = *work_;
  w.fill(kkt);
  if (!w.factor.factor_symmetric(w.plan, w.pivots.data()))
    throw SolveError("solver block: a pivot is zero; give every body a mass and an inertia above zero");
  w.measure_pivots(kkt);
}

SolveReport BlockSolver::solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  Work& w = *work_;
  const int n = kkt.pattern.n, m = kkt.pattern.m;
  SolveReport report;
  w.rule.iterate(kkt, f, c, a, lambda, report, [&](VecX& x, VecX& l) {
    w.rhs.head(n) = w.rule.force_residual();
    w.rhs.tail(m) = w.rule.row_residual();
    w.factor.solve(w.plan, w.rhs.data());
    x += w.rhs.head(n);
    l += w.rhs.tail(m);
  });
  report.smallest_pivot = w.smallest_pivot;
  // Contradictory rows are dependent always; a small pivot beyond the usual ones tells a singular place, to be passed.
  report.contradictory = w.rule.largest() > kContradiction && w.rule.stalled() && w.n_small <= w.n_small_usual;
  return report;
}

void BlockSolver::complete(SolveReport& report) const {
  Work& w = *work_;
  const auto n_usual = w.n_small_usual;
  if (n_usual >= static_cast<int>(w.relative.size())) return;
  std::copy(w.relative.begin(), w.relative.end(), w.scratch.begin());
  const auto place = w.scratch.begin() + n_usual;
  std::nth_element(w.scratch.begin(), place, w.scratch.end());
  report.detector = *place;
}

long BlockSolver::multiplications() const { return work_->plan.multiplications; }

}  // namespace lockstep
