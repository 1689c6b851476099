// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <algorithm>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include "framework/dynamics/solvers/block_factor.h"
#include "framework/dynamics/solvers/products.h"
#include "framework/dynamics/solvers/stop_rule.h"

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
  explicit BlockFactorization(const KktPattern& pattern) {
    plan_.lay_out(graph_of(pattern), true);
    factor_.lay_out(plan_);
    const int n_slots = static_cast<int>(pattern.width.size());
    for (int k = 0; k < n_slots; ++k) mass_.push_back(plan_.find(k, k));
    int node = n_slots;
    for (const KktLink& link : pattern.links) {
      for (int i = 0; i < link.n_slots; ++i) jacobian_.push_back(plan_.find(node, link.slot[i]));
      proximal_.push_back(plan_.find(node, node));
      ++node;
    }
    for (VecX* v : {&rhs_, &pivots_}) v->setZero(pattern.n + pattern.m);
    rule_.analyse(pattern, plan_.proximal());
    watch_.begin(pattern.m);
  }

  void compute(const Kkt& kkt) override {
    fill(kkt);
    if (!factor_.factor_symmetric(plan_, pivots_.data()))
      throw SolveError("solver block: a pivot is zero; give every body a mass and an inertia above zero");
    measure_pivots(kkt);
  }

  SolveReport solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
    const int n = kkt.pattern.n, m = kkt.pattern.m;
    return rule_.iterate(kkt, f, c, a, lambda, watch_, [&](const VecX& r_f, const VecX& r_c, VecX& da, VecX& dl) {
      rhs_.head(n) = r_f;
      rhs_.tail(m) = r_c;
      factor_.solve(plan_, rhs_.data());
      da = rhs_.head(n);
      dl = rhs_.tail(m);
    });
  }

  void complete(SolveReport& report) override { watch_.report(report); }

 private:
  BlockPlan plan_;
  BlockFactor<double> factor_;
  std::vector<BlockPlan::Place> mass_, jacobian_, proximal_;  // of slots; of links and their slots; of links
  VecX rhs_, pivots_;
  StopRule rule_;
  PivotWatch watch_;

  void fill(const Kkt& kkt) {
    const KktPattern& pattern = kkt.pattern;
    factor_.clear();
    const BlockPlan::Place* place = mass_.data();
    for_each_mass(pattern, [&](int, int width, std::size_t at) {
      std::copy_n(kkt.M.data() + at, width * width, factor_.at(place++->at));
    });
    place = jacobian_.data();
    for_each_jacobian(pattern, [&](const KktLink& link, int, int width, std::size_t at) {
      const double* J = kkt.J.data() + at;
      double* out = factor_.at(place->at);
      if (!place++->transposed) {
        std::copy_n(J, link.m * width, out);
        return;
      }
      for (int j = 0; j < link.m; ++j)
        for (int k = 0; k < width; ++k) out[k * link.m + j] = J[j * width + k];
    });
    place = proximal_.data();
    for (const KktLink& link : pattern.links) {
      double* out = factor_.at(place++->at);
      for (int j = 0; j < link.m; ++j) out[j * (link.m + 1)] = -plan_.proximal() * kkt.E[link.first_row + j];
    }
  }

  // A row whose slots are not all eliminated before it may have a small pivot because those that are do not move along it:
  // what the others add to it counts as if they were free.
  void measure_pivots(const Kkt& kkt) {
    const BlockPlan::Place* place = jacobian_.data();
    auto pivots = pivots_.tail(kkt.pattern.m);
    add_row_diagonal(kkt, pivots, [&] { return !place++->transposed; });
    rule_.show_pivots(kkt, watch_, [&](int j) { return pivots[j]; });
  }
};

TypeInfo BlockSolver::info() {
  return {"block", "LDL^T in blocks, leaves first: linear cost on open chains, handles redundant constraints", {}};
}
std::unique_ptr<LinearSolver> BlockSolver::make(const Params&) { return std::make_unique<BlockSolver>(); }

std::unique_ptr<Factorization> BlockSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<BlockFactorization>(pattern);
}

}  // namespace lockstep
