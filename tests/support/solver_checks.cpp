// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/solver_checks.h"

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/dense.h"

namespace lockstep::test {

Solved solve_once(const LinearSolver& solver, const KktSystem& system) {
  Solved out;
  out.factor = solver.analyse(system.kkt.pattern);
  out.factor->compute(system.kkt);
  out.report = out.factor->solve(system.kkt, system.f, system.c, out.a, out.lambda);
  return out;
}

void check_against_truth(const LinearSolver& solver, bool redundant, double tolerance_a, double tolerance_lambda,
                         int left_out) {
  for (int shape = 0; shape < kShapes; ++shape)
    for (unsigned seed = 1; seed <= 5; ++seed) {
      if (shape == left_out) continue;
      CAPTURE(shape, seed);
      const KktSystem system = random_system(shape, seed, redundant);
      const KktSolution truth = solve_exactly(system);
      const Solved found = solve_once(solver, system);
      CHECK(difference(found.a, truth.a) <= tolerance_a);
      CHECK(difference(found.lambda, truth.lambda) <= tolerance_lambda);
      CHECK(found.report.residual <= 1e-12);
      CHECK_FALSE(found.report.contradictory);
      if (found.report.rank >= 0) CHECK(found.report.rank == truth.rank);
      if (redundant && truth.rank < system.kkt.pattern.m) CHECK(found.report.smallest_pivot < 1e-6);
      if (!redundant && system.kkt.pattern.m > 0) CHECK(found.report.smallest_pivot > 1e-6);
    }
}

void check_redundancy_does_not_reach_a(const LinearSolver& solver, double tolerance) {
  KktBuilder with(7), without(7);
  for (KktBuilder* b : {&with, &without}) {
    b->slot(), b->slot();
    b->link({0}, rows_of(3, 2));
    b->link({0, 1}, rows_of(3, 2));
  }
  with.doubled(1);
  const KktSystem full = with.finish();
  KktSystem cut = without.finish();
  const int m = cut.kkt.pattern.m;
  cut.kkt.M = full.kkt.M, cut.kkt.Minv = full.kkt.Minv;
  cut.write_J(full.J().topRows(m));
  cut.f = full.f, cut.c = full.c.head(m);
  cut.kkt.update_scales();
  CHECK(difference(solve_once(solver, full).a, solve_once(solver, cut).a) <= tolerance);
}

void check_axes_do_not_matter(const LinearSolver& solver, double tolerance) {
  const KktSystem plain = random_system(0, 11, true);
  const KktLink& link = plain.kkt.pattern.links.back();
  KktBuilder b(12);
  const MatX Q = dense::orthogonal(b.numbers(3, 3));
  KktSystem turned = plain;
  MatX J = plain.J();
  J.middleRows(link.first_row, 3) = Q * J.middleRows(link.first_row, 3);
  turned.write_J(J);
  turned.c.segment(link.first_row, 3) = Q * plain.c.segment(link.first_row, 3);
  turned.kkt.update_scales();
  CHECK(difference(turned.kkt.E, plain.kkt.E) <= 1e-12);

  const Solved one = solve_once(solver, plain), two = solve_once(solver, turned);
  VecX expected = one.lambda;
  expected.segment(link.first_row, 3) = Q * one.lambda.segment(link.first_row, 3);
  CHECK(difference(two.lambda, expected) <= tolerance);
  CHECK(difference(two.a, one.a) <= 1e-10);
}

void check_contradiction(const LinearSolver& solver) {
  KktBuilder b(3);
  b.slot(), b.slot();
  b.link({0, 1}, rows_of(3, 2));
  b.link({0}, rows_of(0, 0, 1));
  b.link({0}, rows_of(0, 0, 1));
  KktSystem system = b.finish();
  MatX J = system.J();
  J.row(6) = J.row(5);
  system.write_J(J);
  system.kkt.update_scales();
  system.c[5] = 1.0, system.c[6] = 3.0;
  const Solved found = solve_once(solver, system);
  CHECK(found.report.contradictory);
  CHECK((found.report.worst_row == 5 || found.report.worst_row == 6));
  CHECK(std::abs((J * found.a - system.c)[6]) == Approx(1.0).epsilon(1e-6));
  CHECK(std::abs((J * found.a - system.c)[5]) == Approx(1.0).epsilon(1e-6));

  system.c[6] = 1.0;
  CHECK_FALSE(solve_once(solver, system).report.contradictory);
}

void check_singular_place(const LinearSolver& solver) {
  KktBuilder b(5);
  b.slot();
  b.link({0}, rows_of(0, 0, 1));
  b.link({0}, rows_of(0, 0, 1));
  KktSystem system = b.finish();
  const Solved regular = solve_once(solver, system);
  CHECK(regular.report.smallest_pivot > 1e-3);
  MatX J = system.J();
  J.row(1) = J.row(0);
  system.write_J(J);
  system.kkt.update_scales();
  system.kkt.redundant = 0;  // elsewhere
  system.c[0] = 1.0, system.c[1] = 3.0;
  VecX a, lambda;
  regular.factor->compute(system.kkt);
  const SolveReport report = regular.factor->solve(system.kkt, system.f, system.c, a, lambda);
  CHECK_FALSE(report.contradictory);
  CHECK(report.residual > 1e-2);
  CHECK(report.smallest_pivot < 1e-6);
}

void check_detector(const LinearSolver& solver) {
  KktBuilder b(9);
  b.slot();
  const int n = 2;
  const std::size_t twin = b.link({0}, rows_of(2, 0));
  b.doubled(twin);  // redundant everywhere: n small pivots, always
  b.link({0}, rows_of(0, 0, 1));
  b.link({0}, rows_of(0, 0, 1));
  KktSystem system = b.finish();
  system.kkt.redundant = n;
  const MatX regular = system.J();
  const auto factor = solver.analyse(system.kkt.pattern);
  const auto detector_at = [&](double angle) {
    MatX J = regular;
    J.row(2 * n + 1) = std::cos(angle) * regular.row(2 * n) + std::sin(angle) * regular.row(2 * n + 1);
    system.write_J(J);
    system.kkt.update_scales();
    factor->compute(system.kkt);
    VecX a, lambda;
    SolveReport report = factor->solve(system.kkt, system.f, J * VecX::Ones(6), a, lambda);
    factor->complete(report);
    CHECK(report.smallest_pivot < 1e-6);
    return report.detector;
  };
  CHECK(detector_at(kPi / 2) > 1e-2);
  const double far = detector_at(0.01), near = detector_at(0.001);
  CHECK(far < 1e-3);
  CHECK(std::log10(far / near) == Approx(2).margin(0.03));  // the proximal term is 4 % of the smaller one
}

void check_rows_without_scale(const LinearSolver& solver) {
  KktBuilder b(21);
  for (int i = 0; i < 7; ++i) b.slot(), b.link(i == 0 ? std::vector{0} : std::vector{i, i - 1}, rows_of(2, 3));
  b.link({6}, rows_of(2, 3));
  KktSystem system = b.finish();
  constexpr int locked[] = {0, 2, 3, 4, 5};  // y is free
  MatX J = MatX::Zero(system.kkt.pattern.m, system.kkt.pattern.n);
  for (const KktLink& link : system.kkt.pattern.links)
    for (int j = 0; j < link.m; ++j)
      for (int i = 0; i < link.n_slots; ++i) J(link.first_row + j, 6 * link.slot[i] + locked[j]) = i == 0 ? 1.0 : -1.0;
  system.write_J(J);
  system.kkt.update_scales();
  VecX fall = VecX::Zero(42), drive = VecX::Zero(42);
  for (int i = 0; i < 7; ++i) fall[6 * i + 1] = -9.81, drive[6 * i] = 0.7 * i;

  system.f = system.M() * fall, system.c.setZero();
  const Solved falling = solve_once(solver, system);
  CHECK(falling.report.residual <= 1e-12);
  CHECK(difference(falling.a, fall) <= 1e-12);

  system.f.setZero(), system.c = J * drive;
  const Solved driven = solve_once(solver, system);
  CHECK(driven.report.residual <= 1e-12);
  CHECK_FALSE(driven.report.contradictory);
  CHECK(difference(driven.a, solve_exactly(system).a) <= 1e-10);
}

}  // namespace lockstep::test
