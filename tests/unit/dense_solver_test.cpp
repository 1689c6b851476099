// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <lockstep/author/params.h>
#include <lockstep/error.h>
#include "tests/support/allocations.h"
#include "tests/support/messages.h"
#include "tests/support/solver_checks.h"

namespace dense_solver_test {

using lockstep::testing::message_of, lockstep::testing::says;

using namespace lockstep;
using namespace lockstep::test;

TEST_CASE("dense solves regular systems of every shape", "[unit][kkt]") {
  DenseSolver solver;
  check_against_truth(solver, false, 1e-10, 1e-9);
}

TEST_CASE("dense solves redundant constraints: a exact, lambda smallest in the metric of E", "[unit][kkt]") {
  DenseSolver solver;
  check_against_truth(solver, true, 1e-10, 1e-9);
}

TEST_CASE("dense: redundant constraints do not affect a", "[unit][kkt]") {
  DenseSolver solver;
  check_redundancy_does_not_reach_a(solver, 1e-11);
}

TEST_CASE("dense: redundant reactions do not depend on the axes of their constraints", "[unit][kkt]") {
  DenseSolver solver;
  check_axes_do_not_matter(solver, 1e-10);
}

TEST_CASE("dense distinguishes contradictory constraints from a singular configuration", "[unit][kkt]") {
  DenseSolver solver;
  check_contradiction(solver);
  check_singular_place(solver);
}

TEST_CASE("dense's detector falls as the square of the way to a singular place", "[unit][kkt]") {
  DenseSolver solver;
  check_detector(solver);
}

TEST_CASE("dense meets the rule if constraints have no scale", "[unit][kkt]") {
  DenseSolver solver;
  check_rows_without_scale(solver);
}

TEST_CASE("dense asks for no memory after analyse", "[unit][kkt]") {
  DenseSolver solver;
  // 100 bodies are enough for the blocked and the temporary-hungry paths of the matrix library.
  KktBuilder b(9);
  std::size_t last = 0;
  for (int i = 0; i < 100; ++i) b.slot(), last = b.link(i == 0 ? std::vector{0} : std::vector{i - 1, i}, rows_of(3, 2));
  b.doubled(last);
  KktSystem regular = b.finish(), system = regular;
  MatX J = system.J();
  J.row(3) = J.row(4);  // one rank less than the first time
  system.write_J(J);
  system.c[3] = system.c[4];
  VecX a(system.kkt.pattern.n), lambda(system.kkt.pattern.m);
  const auto factor = solver.analyse(system.kkt.pattern);
  SolveReport one, two;
  const long asked = allocations_of([&] {
    regular.kkt.update_scales();
    factor->compute(regular.kkt);
    one = factor->solve(regular.kkt, regular.f, regular.c, a, lambda);
    system.kkt.update_scales();
    factor->compute(system.kkt);
    two = factor->solve(system.kkt, system.f, system.c, a, lambda);
  });
  CHECK(asked == 0);
  CHECK(one.rank == 500);
  CHECK(two.rank == 499);
  if (allocations_are_counted()) CHECK(allocations_of([&] { solver.analyse(system.kkt.pattern); }) > 0);
}

TEST_CASE("dense names the body whose mass is not positive", "[unit][kkt]") {
  DenseSolver solver;
  KktSystem system = random_system(0, 1, false);
  system.kkt.M[system.kkt.pattern.M[2]] = 0.0;
  const auto factor = solver.analyse(system.kkt.pattern);
  const std::string message = message_of<SolveError>([&] { factor->compute(system.kkt); });
  CHECK(says(message, {"dense", "rigid group 2", "not positive definite"}));
}

TEST_CASE("dense is made by name, without keys", "[unit][kkt]") {
  CHECK(DenseSolver::info().name == "dense");
  CHECK_NOTHROW(check_type_info(DenseSolver::info()));
  CHECK(DenseSolver::make(Params{})->name() == "dense");
}

}  // namespace dense_solver_test
