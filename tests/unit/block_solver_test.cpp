// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include "tests/support/allocations.h"
#include "tests/support/block_work.h"
#include "tests/support/messages.h"
#include "tests/support/solver_checks.h"

namespace block_solver_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

/// Chain, comb or hub of n bodies on revolutes.
enum class Topology { chain, loop, hub };
KktSystem mechanism(Topology topology, int n) {
  KktBuilder b(17);
  for (int i = 0; i < n; ++i) {
    b.slot();
    const int before = topology == Topology::hub ? 0 : i - 1;
    b.link(i == 0 ? std::vector{0} : std::vector{before, i}, rows_of(3, 2));
  }
  if (topology == Topology::loop) b.link({n - 1}, rows_of(3, 0));
  KktSystem out;
  return b.finish();
}
long work(Topology topology, int n) {
  BlockGraph graph{std::vector<int>(n, 6), {}, n, {}};
  for (int i = 0; i < n; ++i) {
    graph.width.push_back(5);
    graph.edges.emplace_back(i, n + i);
    if (i > 0) graph.edges.emplace_back(topology == Topology::hub ? 0 : i - 1, n + i);
  }
  if (topology == Topology::loop) graph.width.push_back(3), graph.edges.emplace_back(n - 1, 2 * n);
  for (int first = 0; const int width : graph.width) graph.first.push_back(first), first += width;
  BlockPlan plan;
  plan.lay_out(graph, true);
  return multiplications(plan);
}

}  // namespace

TEST_CASE("block solves regular systems of every shape", "[unit][kkt]") {
  BlockSolver solver;
  check_against_truth(solver, false, 1e-10, 1e-9);
}

TEST_CASE("block solves redundant constraints: a exact, lambda smallest in the metric of E", "[unit][kkt]") {
  BlockSolver solver;
  check_against_truth(solver, true, 1e-10, 1e-6);
}

TEST_CASE("block: redundant constraints do not affect a", "[unit][kkt]") {
  BlockSolver solver;
  check_redundancy_does_not_reach_a(solver, 1e-11);
}

TEST_CASE("block: redundant reactions do not depend on the axes of their constraints", "[unit][kkt]") {
  BlockSolver solver;
  check_axes_do_not_matter(solver, 1e-6);
}

TEST_CASE("block distinguishes contradictory constraints from a singular configuration", "[unit][kkt]") {
  BlockSolver solver;
  check_contradiction(solver);
  check_singular_place(solver);
}

TEST_CASE("block's detector falls as the square of the way to a singular place", "[unit][kkt]") {
  BlockSolver solver;
  check_detector(solver);
}

TEST_CASE("block meets the rule if constraints have no scale", "[unit][kkt]") {
  BlockSolver solver;
  check_rows_without_scale(solver);
}

TEST_CASE("block and dense agree on chains, loops and a hub", "[unit][kkt]") {
  BlockSolver block;
  DenseSolver dense;
  for (const Topology topology : {Topology::chain, Topology::loop, Topology::hub}) {
    CAPTURE(static_cast<int>(topology));
    const KktSystem system = mechanism(topology, 30);
    const Solved one = solve_once(block, system), two = solve_once(dense, system);
    CHECK(difference(one.a, two.a) <= 1e-9);
    CHECK(difference(one.lambda, two.lambda) <= 1e-8);
  }
}

TEST_CASE("block costs the same for every body of a tree, and of a loop", "[unit][kkt]") {
  for (const Topology topology : {Topology::chain, Topology::loop, Topology::hub}) {
    CAPTURE(static_cast<int>(topology));
    const double hundred = static_cast<double>(work(topology, 100)) / 100;
    const double thousand = static_cast<double>(work(topology, 1000)) / 1000;
    CHECK(thousand == Approx(hundred).epsilon(0.02));
  }
  // a body: 56 for its triangle, 21 5 for W, 5 6 5 for the link's block; the link 35, 15 6, 6 5 6
  for (const Topology topology : {Topology::chain, Topology::hub})
    CHECK(work(topology, 1000) <= 1000 * (56 + 105 + 150 + 35 + 90 + 180));
}

TEST_CASE("block allocates nothing after analyse", "[unit][kkt]") {
  if (!allocations_are_counted()) return;
  BlockSolver solver;
  const KktSystem system = random_system(1, 4, true);
  VecX a, lambda;
  const auto factor = solver.analyse(system.kkt.pattern);
  factor->compute(system.kkt);
  factor->solve(system.kkt, system.f, system.c, a, lambda);
  CHECK(allocations_of([&] {
          factor->compute(system.kkt);
          factor->solve(system.kkt, system.f, system.c, a, lambda);
        }) == 0);
}

TEST_CASE("block forgets nothing between factors", "[unit][kkt]") {
  BlockSolver solver;
  const KktSystem system = random_system(1, 4, true);
  const Solved first = solve_once(solver, system);
  KktSystem other = system;
  for (double& v : other.kkt.J) v *= -0.3;
  other.kkt.update_scales();
  VecX a, lambda;
  first.factor->compute(other.kkt);
  first.factor->solve(other.kkt, other.f, other.c, a, lambda);
  first.factor->compute(system.kkt);
  first.factor->solve(system.kkt, system.f, system.c, a, lambda);
  CHECK(a == first.a);
  CHECK(lambda == first.lambda);
}

TEST_CASE("block reports a matrix without a pivot", "[unit][kkt]") {
  BlockSolver solver;
  KktSystem system = random_system(6, 1, false);
  std::fill(system.kkt.M.begin(), system.kkt.M.end(), 0.0);
  const auto factor = solver.analyse(system.kkt.pattern);
  testing::check_words(testing::message_of<SolveError>([&] { factor->compute(system.kkt); }),
                       {"solver block: a pivot is zero", "give every body a mass"});
}

TEST_CASE("block is made by name, without keys", "[unit][kkt]") {
  CHECK(BlockSolver::info().name == "block");
  CHECK_NOTHROW(check_type_info(BlockSolver::info()));
  CHECK(BlockSolver::make(Params{})->name() == "block");
}

TEST_CASE("block loses no digits on a long tree driven all along", "[unit][kkt]") {
  // A cantilever of 200 stiff joints: its softest direction has an eigenvalue of 1e-9 in J M^-1 J^T, less than the
  // proximal term that loops need.
  KktBuilder b(5);
  for (int i = 0; i < 200; ++i) b.slot(), b.link(i == 0 ? std::vector{0} : std::vector{i - 1, i}, rows_of(3, 3));
  KktSystem system = b.finish();
  MatX J = MatX::Zero(system.kkt.pattern.m, system.kkt.pattern.n);
  for (int i = 0; i < 200; ++i)
    for (const int side : {0, 1}) {
      if (i == 0 && side == 1) continue;
      const int slot = side == 0 ? i : i - 1;
      const double sign = side == 0 ? 1 : -1;
      J.block(6 * i, 6 * slot, 6, 6) = sign * MatX::Identity(6, 6);
      J(6 * i + 1, 6 * slot + 5) = -0.5;  // y of the joint, half a length from the centre: - turn about z
    }
  system.write_J(J);
  std::fill(system.kkt.M.begin(), system.kkt.M.end(), 0.0), system.kkt.Minv = system.kkt.M;
  for (int i = 0; i < 200; ++i)
    for (int k = 0; k < 6; ++k) {
      const std::size_t at = system.kkt.pattern.M[i] + static_cast<std::size_t>(7 * k);
      system.kkt.M[at] = k < 3 ? 1.0 : 1.0 / 12, system.kkt.Minv[at] = 1.0 / system.kkt.M[at];
    }
  system.kkt.update_scales();
  system.c.setOnes(), system.f.setZero();
  BlockSolver solver;
  const Solved found = solve_once(solver, system);
  CHECK(found.report.residual <= 1e-12);
  CHECK(found.a[5] == Approx(1.0).epsilon(1e-10));              // the first body: turns by c alone
  CHECK(found.a[6 * 199 + 5] == Approx(200.0).epsilon(1e-10));  // the last: by all of them
}

}  // namespace block_solver_test
