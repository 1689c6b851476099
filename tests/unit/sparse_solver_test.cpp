// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include "tests/support/messages.h"
#include "tests/support/solver_checks.h"

namespace sparse_solver_test {

using namespace lockstep;
using namespace lockstep::test;

TEST_CASE("sparse solves regular systems of every shape", "[unit][kkt]") {
  SparseSolver solver;
  check_against_truth(solver, false, 1e-10, 1e-9);
}

TEST_CASE("sparse solves redundant constraints: a exact, lambda smallest in the metric of E", "[unit][kkt]") {
  SparseSolver solver;
  check_against_truth(solver, true, 1e-10, 1e-6);
}

TEST_CASE("sparse: redundant constraints do not affect a", "[unit][kkt]") {
  SparseSolver solver;
  check_redundancy_does_not_reach_a(solver, 1e-11);
}

TEST_CASE("sparse: redundant reactions do not depend on the axes of their constraints", "[unit][kkt]") {
  SparseSolver solver;
  check_axes_do_not_matter(solver, 1e-6);
}

TEST_CASE("sparse distinguishes contradictory constraints from a singular configuration", "[unit][kkt]") {
  SparseSolver solver;
  check_contradiction(solver);
  check_singular_place(solver);
}

TEST_CASE("sparse's detector falls as the square of the way to a singular place", "[unit][kkt]") {
  SparseSolver solver;
  check_detector(solver);
}

TEST_CASE("sparse meets the rule if constraints have no scale", "[unit][kkt]") {
  SparseSolver solver;
  check_rows_without_scale(solver);
}

TEST_CASE("sparse and dense agree", "[unit][kkt]") {
  SparseSolver sparse;
  DenseSolver dense;
  for (int shape = 0; shape < kShapes; ++shape)
    for (const bool redundant : {false, true}) {
      CAPTURE(shape, redundant);
      const KktSystem system = random_system(shape, 31, redundant);
      const Solved one = solve_once(sparse, system), two = solve_once(dense, system);
      CHECK(difference(one.a, two.a) <= 1e-10);
      CHECK(difference(one.lambda, two.lambda) <= (redundant ? 1e-6 : 1e-9));
    }
}

TEST_CASE("sparse corrects at most three times, and never an exact solution", "[unit][kkt]") {
  SparseSolver solver;
  CHECK(solve_once(solver, random_system(6, 1, false)).report.corrections <= 1);  // no rows
  for (int shape = 0; shape < kShapes; ++shape)
    CHECK(solve_once(solver, random_system(shape, 2, true)).report.corrections <= 3);
}

TEST_CASE("sparse forgets nothing between factors", "[unit][kkt]") {
  SparseSolver solver;
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

TEST_CASE("sparse reports a matrix without a pivot", "[unit][kkt]") {
  SparseSolver solver;
  KktSystem system = random_system(6, 1, false);
  std::fill(system.kkt.M.begin(), system.kkt.M.end(), 0.0);
  const auto factor = solver.analyse(system.kkt.pattern);
  testing::check_words(testing::message_of<SolveError>([&] { factor->compute(system.kkt); }),
                       {"solver sparse: a pivot is zero", "give every body a mass"});
}

TEST_CASE("sparse is made by name, without keys", "[unit][kkt]") {
  CHECK(SparseSolver::info().name == "sparse");
  CHECK_NOTHROW(check_type_info(SparseSolver::info()));
  CHECK(SparseSolver::make(Params{})->name() == "sparse");
}

}  // namespace sparse_solver_test
