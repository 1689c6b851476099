// SPDX-License-Identifier: BSD-3-Clause
// Evaluation, Factor, StateEditor: what a caller may hold, and what of it stays true when the state moves on.
#include <lockstep/detail/newton.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/loops.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"

namespace evaluation_test {

using namespace lockstep;

namespace {

std::unique_ptr<LinearSolver> solver_number(int i) {
  if (i == 0) return std::make_unique<DenseSolver>();
  if (i == 1) return std::make_unique<SparseSolver>();
  if (i == 2) return std::make_unique<BlockSolver>();
  return std::make_unique<SchurSolver>();
}

/// The pendulum turned by an angle about its hinge, at rest.
State turned(const System& system, double angle) {
  State s = system.start();
  const Pose turn{Vec3::Zero(), axis_angle(Vec3(0, 1, 0), angle)};
  StateEditor(s).set_pose(system.body("rod"), turn * body_pose(system.body("rod"), s));
  return s;
}

struct Answer {
  VecX a, lambda;
};
Answer solve(Factor& factor, const Evaluation& e) {
  Answer out;
  factor.solve(e, e.force(), VecX::Zero(e.rows().n_rows), out.a, out.lambda);
  return out;
}

}  // namespace

TEST_CASE("Two factors of two evaluations live side by side", "[unit][dynamics]") {
  const int i = GENERATE(0, 1, 2, 3);
  CAPTURE(i);
  RodPendulum pendulum;
  System& system = pendulum.system;
  Dynamics dynamics(system, solver_number(i));
  const State here = system.start(), there = turned(system, 0.4);
  Evaluation e1(system, here), e2(system, there);
  Factor f1 = dynamics.new_factor(), f2 = dynamics.new_factor();
  f1.compute(e1), f2.compute(e2);
  const Answer one = solve(f1, e1), two = solve(f2, e2), again = solve(f1, e1);
  CHECK(dynamics.work().factors == 2);
  CHECK(one.a == again.a);
  CHECK((one.a - two.a).norm() > 0.1);
  CHECK((one.a - dynamics.evaluate(here).a).norm() <= 1e-12);  // at rest Qhat is zero
  CHECK((two.a - dynamics.evaluate(there).a).norm() <= 1e-12);
}

TEST_CASE("A kept factor iterates onto the constraints of a later state", "[unit][dynamics]") {
  const int i = GENERATE(0, 1, 2, 3);
  CAPTURE(i);
  RodPendulum pendulum;
  Dynamics dynamics(pendulum.system, solver_number(i));
  State s = pendulum.system.start();
  Factor factor = dynamics.new_factor();
  Evaluation e(pendulum.system, s);
  factor.compute(e);
  s.q[0] += 1e-3, s.q[1] -= 2e-3;
  VecX C, Cd, d, lambda;
  for (int round = 0; round < 8; ++round) {
    e.at(s);
    e.residuals(C, Cd);
    factor.solve(e, VecX::Zero(s.v.size()), -C, d, lambda);
    advance_state(s, 1.0, d);
  }
  CHECK(dynamics.work().factors == 1);
  CHECK(dynamics.violation(s) <= 1e-14);
}

TEST_CASE("A factor without a matrix, or of other joints than the active ones, is rejected in words",
          "[unit][dynamics]") {
  RodPendulum pendulum;
  Dynamics dynamics(pendulum.system, std::make_unique<SchurSolver>());
  State s = pendulum.system.start();
  Evaluation e(pendulum.system, s);
  Factor factor = dynamics.new_factor();
  const auto refused = [&] {
    testing::check_words(testing::message_of<ModelError>([&] { solve(factor, e); }), {"factor", "compute it again"});
  };
  refused();
  factor.compute(e);
  CHECK_NOTHROW(solve(factor, e));
  s.modes[0] = false;
  e.at(s);
  refused();
  factor.compute(e);
  CHECK_NOTHROW(solve(factor, e));
}

namespace {

/// A four-bar with all of its bars on one line.
State flat_four_bar(const System& system) {
  State s = system.start();
  const Quat down = axis_angle(Vec3(0, 0, 1), -1.2);
  StateEditor edit(s);
  edit.set_pose(system.body("upright0"), {Vec3(0.5, 0, 0), down});
  edit.set_pose(system.body("upright1"), {Vec3(1.5, 0, 0), down});
  edit.set_pose(system.body("bar0"), {Vec3(1.5, 0, 0), {}});
  return s;
}

}  // namespace

TEST_CASE("The result in a singular configuration does not depend on earlier requests", "[unit][dynamics]") {
  const int i = GENERATE(0, 1, 2, 3);
  CAPTURE(i);
  System system = loops::row_of_four_bars(1);
  system.setup();
  const State flat = flat_four_bar(system);
  Dynamics fresh(system, solver_number(i)), used(system, solver_number(i));
  CHECK(fresh.violation(flat) < 1e-12);
  CHECK(used.redundancy(system.start()).rows == 3);
  const auto detector = [&](Dynamics& dynamics) { return dynamics.evaluate(flat).full_report().detector; };
  const double known = detector(used);
  CHECK(known < 1e-6);  // one more than usual: singular
  CHECK(detector(fresh) == known);
  Evaluation e(system, system.start());
  Factor factor = fresh.new_factor();
  factor.compute(e);
  factor.forget();
  testing::check_words(testing::message_of<ModelError>([&] { solve(factor, e); }), {"factor", "compute it again"});
}

TEST_CASE("Poses and twists of bodies are set and read alike, parts of a cluster too", "[unit][system]") {
  System system;
  Body& arm = system.add_body("arm", MassProperties{2.0, Vec3(0.1, 0.2, 0.3), Mat3::Identity()}, {Vec3(1, 0, 0), {}});
  Body& tool = system.add_body("tool", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()},
                               {Vec3(1, 1, 0), axis_angle(Vec3(1, 0, 0), 0.7)});
  system.add<Fixed>("weld", tool, arm, pose_at(Vec3(1, 1, 0)));
  system.set_merge(true);
  system.setup();
  State s = system.start();
  StateEditor edit(s);
  const Pose there{Vec3(0.3, -0.4, 0.5), axis_angle(Vec3(0, 0.6, 0.8), 1.1)};
  const Twist moving{Vec3(1, 2, 3), Vec3(-0.5, 0.4, 0.3)};
  const Pose between = inverse(edit.pose(arm)) * edit.pose(tool);
  edit.set_twist(tool, moving);
  edit.set_pose(tool, there);
  CHECK((edit.pose(tool).x - there.x).norm() <= 1e-15);
  CHECK((edit.pose(tool).q.coefficients() - there.q.coefficients()).norm() <= 1e-15);
  CHECK((edit.twist(tool).v - moving.v).norm() <= 1e-15);
  CHECK((edit.twist(tool).w - moving.w).norm() <= 1e-15);
  const Pose now = inverse(edit.pose(arm)) * edit.pose(tool);
  CHECK((now.x - between.x).norm() <= 1e-15);
  testing::check_words(testing::message_of<ModelError>([&] { edit.set_pose(system.ground(), {}); }),
                       {"body 'ground'", "does not move"});
}

TEST_CASE("Vectors of another size are rejected, not written past", "[unit][dynamics]") {
  RodPendulum pendulum;
  Dynamics dynamics(pendulum.system, solver_number(GENERATE(0, 3)));
  const State s = pendulum.system.start();
  const Evaluation e(pendulum.system, s);
  VecX none, C, Cd, five = VecX::Zero(5), six = VecX::Zero(6), a, lambda;
  e.residuals(C, Cd);
  REQUIRE(C.size() == 5);
  CHECK(Cd.size() == 5);
  const auto refused = [&](auto&& act) {
    testing::check_words(testing::message_of<ModelError>(act), {"numbers, but", "6 per rigid group"});
  };
  refused([&] { e.velocity_residual(none, Cd); });
  refused([&] { (void)e.norm(six); });
  refused([&] { e.react(five, none); });
  refused([&] { e.react(none, six); });
  Factor factor = dynamics.new_factor();
  factor.compute(e);
  refused([&] { factor.solve(e, none, five, a, lambda); });
  refused([&] { factor.solve(e, six, none, a, lambda); });
  NewtonMatrix newton;
  testing::check_words(testing::message_of<ModelError>([&] { newton.gather(e, none); }),
                       {"lambda has 0 numbers, but 5 are needed", "6 per rigid group"});
  newton.gather(e, five);
  newton.factor(1, 0, 0);
  refused([&] { newton.add_M_times(six, none); });
  refused([&] { newton.add_D_times(none, six); });
  refused([&] { newton.add_K_times(six, five); });
  refused([&] { newton.solve(none, five, a, lambda); });
  refused([&] { newton.solve(six, none, a, lambda); });
}

}  // namespace evaluation_test
