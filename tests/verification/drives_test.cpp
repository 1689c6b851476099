// SPDX-License-Identifier: BSD-3-Clause
// Drives of every kind against closed forms: a speed that is integrated, an actuator, a trajectory, the full motion, a
// motor that pushes instead of holding.
#include <cmath>
#include <memory>

#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace drives_test {

using namespace lockstep;

namespace {

/// Runs to t = 2 s with dop853 at 1e-10 and gives the table.
Table run(System& sys, std::vector<Request> wanted) {
  Recorder recorder(sys, std::move(wanted));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State start = sys.start();
  assemble(dynamics, start);
  StepLoop simulation(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-12}, .output = 0.05});
  simulation.set_state(start);
  simulation.add_observer(recorder);
  simulation.run_until(2.0);
  return recorder.table();
}

template <class Exact>
double worst(const Table& t, const std::string& column, Exact exact) {
  double w = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) keep_worst(w, std::abs(t[column][i] - exact(t["t"][i])));
  return w;
}

MassProperties flywheel() { return {2.0, Vec3::Zero(), Vec3(0.2, 0.2, 0.3).asDiagonal()}; }

}  // namespace

TEST_CASE("a speed law is integrated: angle, speed and torque in closed form", "[verification][drives]") {
  System sys;
  Body& wheel = sys.add_body("wheel", flywheel());
  auto& hinge = sys.add<Revolute>("hinge", wheel, sys.ground(), pose_at({0, 0, 0}));
  hinge.drive_speed(Axis::rz, laws::law([](auto t) { return 3.0 + 2.0 * sin(4.0 * t); }));
  const Table t = run(sys, {"hinge.rz", "hinge.rz_d", "hinge.drive.torque_on_p_link_z", "hinge.drive.work"});
  CHECK(worst(t, "hinge.rz", [](double s) { return 3.0 * s + 0.5 * (1 - std::cos(4 * s)); }) < 1e-9);
  CHECK(worst(t, "hinge.rz_d", [](double s) { return 3.0 + 2.0 * std::sin(4 * s); }) < 1e-9);
  CHECK(worst(t, "hinge.drive.torque_on_p_link_z", [](double s) { return 0.3 * 8.0 * std::cos(4 * s); }) < 1e-8);
  // work of the drive = change of kinetic energy
  CHECK(worst(t, "hinge.drive.work", [](double s) {
          const double w = 3.0 + 2.0 * std::sin(4 * s);
          return 0.5 * 0.3 * (w * w - 9.0);
        }) < 1e-8);
}

TEST_CASE("a driven speed begins at the present coordinate of the mechanism", "[verification][drives]") {
  System sys;
  Body& wheel = sys.add_body("wheel", flywheel(), Pose{{0, 0, 0}, axis_angle(Vec3::UnitZ(), 0.7)});
  Marker& P = sys.add_marker("P", wheel);
  Marker& S = sys.add_marker("S", sys.ground());
  sys.add<Revolute>("hinge", P, S).drive_speed(Axis::rz, laws::ramp(1.0));
  const Table t = run(sys, {"hinge.rz"});
  CHECK(worst(t, "hinge.rz", [](double s) { return 0.7 + 0.5 * s * s; }) < 1e-9);
}

TEST_CASE("a linear actuator on a prismatic joint holds m (a + g)", "[verification][drives]") {
  System sys({.gravity = {0, 0, -9.81}});
  Body& slider = sys.add_body("slider", flywheel());
  sys.add<Prismatic>("guide", slider, sys.ground(), pose_at({0, 0, 0})).drive(Axis::z, laws::sine({.amplitude = 0.2, .omega = 5}));
  const Table t = run(sys, {"guide.z", "guide.drive.force_on_p_link_z", "guide.force_on_p_link_z"});
  CHECK(worst(t, "guide.z", [](double s) { return 0.2 * std::sin(5 * s); }) < 1e-10);
  CHECK(worst(t, "guide.drive.force_on_p_link_z", [](double s) { return 2.0 * (9.81 - 5.0 * std::sin(5 * s)); }) <
        1e-8);
  CHECK(worst(t, "guide.force_on_p_link_z", [](double) { return 0.0; }) <
        1e-12);  // the joint itself does not push along z
}

TEST_CASE("a trajectory leads a point and leaves its rotation free, the full motion leads both",
          "[verification][drives]") {
  const auto path = laws::translation([](auto t) { return std::array{0.3 * sin(2.0 * t), 0.2 * t * t, 0.1 * cos(t) - 0.1}; });
  SECTION("trajectory") {
    System sys;
    Body& body = sys.add_body("body", flywheel());
    body.start.w = {0, 0, 5};
    sys.add<Spherical>("lead", body, sys.ground(), pose_at({0, 0, 0})).move(path);
    const Table t = run(sys, {"body.x", "body.y", "body.z", "body.omega_body_z", "lead.force_on_p_world_y"});
    CHECK(worst(t, "body.x", [](double s) { return 0.3 * std::sin(2 * s); }) < 1e-10);
    CHECK(worst(t, "body.y", [](double s) { return 0.2 * s * s; }) < 1e-10);
    CHECK(worst(t, "body.omega_body_z", [](double) { return 5.0; }) < 1e-9);
    CHECK(worst(t, "lead.force_on_p_world_y", [](double) { return 2.0 * 0.4; }) < 1e-9);
  }
  SECTION("full motion") {
    System sys;
    Body& body = sys.add_body("body", flywheel());
    auto& lead = sys.add<Fixed>("lead", body, sys.ground(), pose_at({0, 0, 0}));
    lead.move(path);
    lead.turn(laws::axis_rotation({0, 0, 1}, laws::sine({.amplitude = 0.8, .omega = 3})));
    const Table t = run(sys, {"body.z", "body.angle_z", "lead.torque_on_p_world_z"});
    CHECK(worst(t, "body.z", [](double s) { return 0.1 * std::cos(s) - 0.1; }) < 1e-10);
    CHECK(worst(t, "body.angle_z", [](double s) { return 0.8 * std::sin(3 * s); }) < 1e-10);
    CHECK(worst(t, "lead.torque_on_p_world_z", [](double s) { return -0.3 * 0.8 * 9 * std::sin(3 * s); }) < 1e-8);
  }
}

TEST_CASE("torque and force motors push without holding", "[verification][drives]") {
  System sys;
  Body& wheel = sys.add_body("wheel", flywheel());
  Body& slider = sys.add_body("slider", flywheel(), Pose{{1, 0, 0}, {}});
  auto& hinge = sys.add<Revolute>("hinge", wheel, sys.ground(), pose_at({0, 0, 0}));
  auto& guide = sys.add<Prismatic>("guide", slider, sys.ground(), pose_at({1, 0, 0}));
  sys.add<TorqueMotor>("motor", sys.marker("hinge.P"), sys.marker("hinge.S"), {.torque = laws::constant(0.6)});
  sys.add<ForceMotor>("push", sys.marker("guide.P"), sys.marker("guide.S"),
                      {.force = laws::sine({.amplitude = 4, .omega = 2})});
  const Table t = run(sys, {"hinge.rz", "guide.z", "energy.balance", "energy.supplied"});
  CHECK(hinge.row_count() == 5);
  CHECK(guide.row_count() == 5);
  CHECK(worst(t, "hinge.rz", [](double s) { return 0.5 * (0.6 / 0.3) * s * s; }) < 1e-9);
  CHECK(worst(t, "guide.z", [](double s) { return 2.0 * (s / 2 - std::sin(2 * s) / 4); }) < 1e-9);
  CHECK(worst(t, "energy.balance", [](double) { return 0.0; }) < 1e-8);
  CHECK(t.last("energy.supplied") > 1.0);
}

TEST_CASE("a start may ask for the speed of a joint's free coordinate", "[verification][drives]") {
  System sys;
  Body& crank = sys.add_body("crank", shapes::rod(1.0, {0, 0, 0}, {0, 0.2, 0}));
  Body& bar = sys.add_body("bar", shapes::rod(1.0, {0, 0.2, 0}, {0.5, 0.2, 0}));
  Body& rocker = sys.add_body("rocker", shapes::rod(1.0, {0.5, 0, 0}, {0.5, 0.2, 0}));
  sys.add<Revolute>("A", crank, sys.ground(), pose_at({0, 0, 0}));
  sys.add<Revolute>("B", bar, crank, pose_at({0, 0.2, 0}));
  sys.add<Revolute>("C", bar, rocker, pose_at({0.5, 0.2, 0}));
  sys.add<Revolute>("D", rocker, sys.ground(), pose_at({0.5, 0, 0}));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State start = sys.start();
  assemble(dynamics, start, {{"A", Axis::rz, 3.0}});
  CHECK(std::abs(body_twist(crank, start).w[2] - 3.0) < 1e-10);
  CHECK(std::abs(body_twist(rocker, start).w[2] - 3.0) < 1e-10);
  CHECK(body_twist(bar, start).w.norm() < 1e-10);  // a parallelogram's coupler does not turn
  CHECK(std::abs(body_twist(bar, start).v[0] + 3.0 * 0.2) < 1e-10);
  testing::check_words(testing::message_of<AssemblyError>([&] {
                         assemble(dynamics, start, {{"A", Axis::rz, 3.0}, {"D", Axis::rz, 2.0}});
                       }),
                       {"A.rz", "D.rz", "are incompatible"});
}

TEST_CASE("a start velocity that no motion has is rejected, for exact and nearly redundant joints",
          "[verification][drives]") {
  const double tilt = GENERATE(0.001, 0.3);  // of a slide out of the plane of a trammel
  System sys;
  Body& bar = sys.add_body("bar", shapes::rod(1.0, {0.3, 0, 0}, {0, 0.4, 0}));
  Body& block1 = sys.add_body("block1", flywheel());
  Body& block2 = sys.add_body("block2", flywheel());
  block1.home.x = {0.3, 0, 0}, block2.home.x = {0, 0.4, 0};
  sys.add<Prismatic>("P1", block1, sys.ground(), pose_at({0.3, 0, 0}, Vec3(1, 0, tilt).normalized()));
  sys.add<Prismatic>("P2", block2, sys.ground(), pose_at({0, 0.4, 0}, Vec3(0, 1, 0)));
  sys.add<Revolute>("R1", bar, block1, pose_at({0.3, 0, 0}));
  sys.add<Revolute>("R2", bar, block2, pose_at({0, 0.4, 0}));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State start = sys.start();
  testing::check_words(testing::message_of<AssemblyError>([&] {
                         assemble(dynamics, start, {{"P1", Axis::z, 0.3}});
                       }),
                       {"start velocity: P1.z is impossible: the joints do not allow this motion"});
}

TEST_CASE("a speed drive that becomes active begins at the present coordinate of the mechanism",
          "[verification][drives]") {
  System sys;
  Body& wheel = sys.add_body("wheel", flywheel());
  wheel.start.w = {0, 0, 2.0};
  Marker& P = sys.add_marker("P", wheel);
  Marker& S = sys.add_marker("S", sys.ground());
  sys.add<Revolute>("bearing", P, S);
  auto& clutch =
      sys.add<AngularAlignment>("brake", P, S);  // never in force: only shows that others may share the markers
  clutch.set_active_at_start(false);
  auto& motor = sys.add<Revolute>("motor", P, S);
  motor.drive_speed(Axis::rz, laws::ramp(1.0, 0.5, 2.0));  // 2 rad/s at t = 0.5 s, then 1 rad/s^2
  motor.set_active_at_start(false);
  Recorder recorder(sys, {"bearing.rz"});
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-12}, .output = 0.1});
  run.add_observer(recorder);
  run.add_event({.name = "engage", .at = 0.5, .activate = {"motor"}});
  run.add_event({.name = "release", .at = 1.5, .deactivate = {"motor"}});
  run.run_until(2.0);
  // 2 t, then 1 + 2 u + u^2/2 for u = t - 0.5, then at 3 rad/s
  const Table& t = recorder.table();
  CHECK(worst(t, "bearing.rz", [](double s) {
          if (s <= 0.5) return 2 * s;
          const double u = std::min(s, 1.5) - 0.5;
          return 1 + 2 * u + 0.5 * u * u + 3 * std::max(0.0, s - 1.5);
        }) < 1e-8);
}

TEST_CASE("a mechanism held at rest by its drives carries its weight, with every solver and formulation",
          "[verification][drives]") {
  const bool dense = GENERATE(false, true);
  const auto formulation = GENERATE(Formulation::omega, Formulation::quaternion);
  System sys({.gravity = {0, -9.81, 0}});
  Body& arm = sys.add_body("arm", shapes::rod(2.0, {0, 0, 0}, {1, 0, 0}));
  Body& fore = sys.add_body("fore", shapes::rod(1.0, {1, 0, 0}, {1.5, 0, 0}));
  auto& shoulder = sys.add<Revolute>("shoulder", arm, sys.ground(), pose_at({0, 0, 0}));
  auto& elbow = sys.add<Revolute>("elbow", fore, arm, pose_at({1, 0, 0}));
  shoulder.drive(Axis::rz, laws::ramp(0.0));
  elbow.drive(Axis::rz, laws::constant(0.0));
  Channel torque = make_channel(sys, "shoulder.drive.torque_on_p_link_z");
  std::unique_ptr<LinearSolver> solver;
  if (dense)
    solver = std::make_unique<DenseSolver>();
  else if (formulation == Formulation::quaternion)
    solver = std::make_unique<SparseSolver>();
  else
    solver = std::make_unique<SchurSolver>();
  Dynamics dynamics(sys, std::move(solver), {formulation, {}});
  const State state = sys.start();
  const Evaluated& values = dynamics.evaluate(state);
  CHECK(values.a.norm() < 1e-10);
  const StepReport none;
  CHECK(std::abs(torque.value(Sample(dynamics, state, none)) - 9.81 * (2.0 * 0.5 + 1.0 * 1.25)) < 1e-9);
}

}  // namespace drives_test
