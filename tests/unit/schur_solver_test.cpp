// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <lockstep/dynamics.h>

#include <lockstep/author/params.h>
#include "framework/dynamics/solvers/schur_plan.h"
#include "tests/support/allocations.h"
#include "tests/support/mechanism.h"
#include "tests/support/schur_on_kkt.h"
#include "tests/support/solver_checks.h"

namespace schur_solver_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {
constexpr int kSevenWide = 4;  // the shape with slots of the paper's form
}  // namespace

TEST_CASE("schur solves regular systems of every shape", "[unit][kkt]") {
  SchurOnKkt solver;
  check_against_truth(solver, false, 1e-10, 1e-9, kSevenWide);
}

TEST_CASE("schur solves redundant constraints: a exact, lambda smallest in the metric of E", "[unit][kkt]") {
  SchurOnKkt solver;
  // rounding grows by 1/eps in the directions that redundant rows leave open, and eps is 1e-9 here
  check_against_truth(solver, true, 1e-9, 1e-5, kSevenWide);
}

TEST_CASE("schur: redundant constraints do not affect a", "[unit][kkt]") {
  SchurOnKkt solver;
  check_redundancy_does_not_reach_a(solver, 1e-11);
}

TEST_CASE("schur: redundant reactions do not depend on the axes of their constraints", "[unit][kkt]") {
  SchurOnKkt solver;
  check_axes_do_not_matter(solver, 1e-6);
}

TEST_CASE("schur distinguishes contradictory constraints from a singular configuration", "[unit][kkt]") {
  SchurOnKkt solver;
  check_contradiction(solver);
  check_singular_place(solver);
}

TEST_CASE("schur's detector falls as the square of the way to a singular place", "[unit][kkt]") {
  SchurOnKkt solver;
  check_detector(solver);
}

TEST_CASE("schur meets the rule if constraints have no scale", "[unit][kkt]") {
  SchurOnKkt solver;
  check_rows_without_scale(solver);
}

namespace {

RowTable table_of(const std::vector<std::vector<int>>& links, int m = 5) {
  RowTable table;
  for (const std::vector<int>& slots : links) {
    RowEntry e;
    e.m = m;
    for (const int s : slots) e.slots.add(s);
    table.entries.push_back(e);
  }
  table.lay_out();
  return table;
}

// Blocks that the elimination of the plan makes and keeps: its work, for links of one size.
std::size_t products(const schur::Plan& plan) { return plan.targets.size(); }

}  // namespace

TEST_CASE("a tree makes no fill, its work and memory grow with the bodies", "[unit][kkt]") {
  std::size_t before = 0, memory = 0;
  for (const int n : {100, 200, 400}) {
    std::vector<std::vector<int>> chain{{0}};
    for (int i = 1; i < n; ++i) chain.push_back({i, i - 1});
    const schur::Plan plan = schur::make_plan(table_of(chain), n, false);
    CHECK(plan.tree);
    CHECK(plan.later.size() == static_cast<std::size_t>(n - 1));  // one a link, but for the last
    CHECK(products(plan) == static_cast<std::size_t>(n - 1));
    if (before > 0) CHECK(products(plan) < 2.02 * double(before));
    const std::size_t bytes = 8 * (plan.size_A + plan.size_Y + 8 * plan.size_x) +
                              plan.nodes.size() * sizeof(schur::Node) + plan.sides.size() * sizeof(schur::Side) +
                              plan.later.size() * sizeof(schur::Later);
    CHECK(bytes < 3000u * static_cast<std::size_t>(n));
    if (memory > 0) CHECK(bytes < 2.02 * double(memory));
    before = products(plan), memory = bytes;
  }
}

TEST_CASE("a hub with fifty joints does not couple them", "[unit][kkt]") {
  std::vector<std::vector<int>> star{{0}};
  for (int i = 1; i <= 50; ++i) star.push_back({i, 0});
  const schur::Plan plan = schur::make_plan(table_of(star), 51, false);
  CHECK(plan.hubs.size() == 1);
  CHECK(products(plan) <= 51);  // 51 links below one hub; as a clique there would be 51 * 52 / 2 * 17
}

TEST_CASE("a joint between hubs alone waits for one of them", "[unit][kkt]") {
  std::vector<std::vector<int>> links{{0, 1}, {0}};
  for (int i = 2; i < 9; ++i) links.push_back({i, 0}), links.push_back({i + 7, 1});
  const schur::Plan plan = schur::make_plan(table_of(links), 16, false);
  CHECK(plan.hubs.size() == 2);
  std::size_t first_hub = 99, between = 99;
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    if (plan.nodes[k].link < 0) first_hub = std::min(first_hub, k);
    if (plan.nodes[k].link == 0) between = k;
  }
  CHECK(first_hub < between);
}

TEST_CASE("loops are distinguished from trees, the ground being one body", "[unit][kkt]") {
  CHECK(schur::make_plan(table_of({{0}, {1, 0}, {2}}), 3, false).tree);
  CHECK_FALSE(schur::make_plan(table_of({{0}, {1, 0}, {1}}), 2, false).tree);
  CHECK_FALSE(schur::make_plan(table_of({{0}, {0}}), 1, false).tree);
  CHECK_FALSE(schur::make_plan(table_of({{0, 1}, {1, 0}}), 2, false).tree);
}

TEST_CASE("schur, sparse and dense agree on random mechanisms, hubs, laws and particles included",
          "[unit][kkt][schur]") {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    inputs::RandomMechanism m(seed);
    const int hub = m.add_body();
    m.link(hub, -1, Mask::xyz | (seed % 2 ? Mask::none : Mask::e1 | Mask::e2), seed % 3 ? oracle::kP : 0u);
    int last = hub;
    for (int i = 0; i < 9; ++i) {
      const int b = i % 4 == 3 ? m.add_particle() : m.add_body();
      m.link(b, i < 7 ? hub : last, i % 4 == 3 ? Mask::x | Mask::y : i % 2 ? Mask::xyz | Mask::e3 : Mask::xyz);
      if (i % 4 != 3) last = b;
    }
    const auto evaluate = [&](std::unique_ptr<LinearSolver> solver) {
      Dynamics dynamics(m.system, std::move(solver));
      const Evaluated& v = dynamics.evaluate(m.system.start());
      return std::pair<VecX, VecX>(v.a, v.lambda);
    };
    const auto [a, lambda] = evaluate(std::make_unique<SchurSolver>());
    const auto [a_dense, lambda_dense] = evaluate(std::make_unique<DenseSolver>());
    const auto [a_sparse, lambda_sparse] = evaluate(std::make_unique<SparseSolver>());
    CHECK(difference(a, a_dense) <= 1e-9);
    CHECK(difference(lambda, lambda_dense) <= 1e-8);
    CHECK(difference(a, a_sparse) <= 1e-9);
    CHECK(difference(lambda, lambda_sparse) <= 1e-8);
  }
}

TEST_CASE("a hub at the end of an arm, near a loop, and a particle as a hub", "[unit][kkt][schur]") {
  const int kind = GENERATE(0, 1, 2);
  CAPTURE(kind);
  inputs::RandomMechanism m(40u + static_cast<unsigned>(kind));
  const int arm = m.add_body(), hub = kind == 2 ? m.add_particle() : m.add_body();
  m.link(arm, -1, Mask::xyz | Mask::e1 | Mask::e2);
  m.link(hub, arm, kind == 2 ? Mask::xyz : Mask::xyz | Mask::e1 | Mask::e2);
  for (int i = 0; i < 8; ++i)
    m.link(m.add_body(), hub, kind == 2 ? Mask::x | Mask::z : Mask::xyz | Mask::e1 | Mask::e2);
  if (kind == 1) {  // a closed loop elsewhere
    const int a = m.add_body(), b = m.add_body();
    m.link(a, -1, Mask::xyz);
    m.link(b, a, Mask::xyz);
    m.link(b, -1, Mask::x | Mask::y);
  }
  const auto evaluate = [&](std::unique_ptr<LinearSolver> solver) {
    Dynamics dynamics(m.system, std::move(solver));
    const Evaluated& v = dynamics.evaluate(m.system.start());
    return std::pair<VecX, VecX>(v.a, v.lambda);
  };
  const auto [a, lambda] = evaluate(std::make_unique<SchurSolver>());
  const auto [a_dense, lambda_dense] = evaluate(std::make_unique<DenseSolver>());
  CHECK(difference(a, a_dense) <= 1e-9);
  CHECK(difference(lambda, lambda_dense) <= 1e-8);
}

TEST_CASE("schur allocates nothing after the first evaluation", "[unit][kkt][schur]") {
  if (!allocations_are_counted()) return;
  inputs::RandomMechanism m(5);
  const int a = m.add_body(), b = m.add_body(), c = m.add_body();
  m.link(a, -1, Mask::xyz | Mask::e1 | Mask::e2);
  m.link(b, a, Mask::xyz | Mask::e1 | Mask::e2);
  m.link(c, b, Mask::xyz);
  m.link(c, -1, Mask::x | Mask::y);
  Dynamics dynamics(m.system, std::make_unique<SchurSolver>());
  const State state = m.system.start();
  StateRate rate;
  dynamics.rate(state, rate);
  CHECK(allocations_of([&] { dynamics.rate(state, rate); }) == 0);
}

TEST_CASE("schur is made by name, without keys", "[unit][kkt]") {
  CHECK(SchurSolver::info().name == "schur");
  CHECK_NOTHROW(check_type_info(SchurSolver::info()));
  CHECK(SchurSolver::make(Params{})->name() == "schur");
}

}  // namespace schur_solver_test
