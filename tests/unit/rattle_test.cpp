// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"

namespace rattle_test {

using namespace lockstep;

TEST_CASE("rattle ends on the constraints, positions and velocities", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Rattle method(4);
  const State s = stepped(dynamics, method, 1.0, 40);
  CHECK(dynamics.violation(s) < 1e-13);
  CHECK(dynamics.violation_v(s) < 1e-12);
  CHECK(s.q.segment<4>(3).norm() == Approx(1).epsilon(1e-15));
}

// Reversible: the same steps back lead to the start, though each of them is wrong by its order.
TEST_CASE("rattle goes back the way it came", "[unit][integrators]") {
  const int order = GENERATE(2, 4);
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Rattle method(order);
  const State start = pendulum.system.start();
  State s = start;
  method.begin(dynamics, s);
  for (int i = 0; i < 20; ++i) method.step(dynamics, s, 0.05);
  REQUIRE((s.q - start.q).norm() > 0.3);
  for (int i = 0; i < 20; ++i) method.step(dynamics, s, -0.05);
  CHECK((s.q - start.q).norm() < 1e-11);
  CHECK((s.v - start.v).norm() < 1e-11);
}

TEST_CASE("evaluations by others between two steps of rattle change nothing", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Rattle method(2);
  State calm = pendulum.system.start(), disturbed = calm;
  method.begin(dynamics, calm);
  for (int i = 0; i < 5; ++i) method.step(dynamics, calm, 0.05);
  method.begin(dynamics, disturbed);
  for (int i = 0; i < 5; ++i) {
    method.step(dynamics, disturbed, 0.05);
    dynamics.evaluate(pendulum.system.start());
  }
  CHECK((calm.q - disturbed.q).norm() < 1e-13);
}

// Two equal rotors on one axis, one of them at rest: J w = 2 J w'.
TEST_CASE("rattle accepts a joint that holds its bodies at their places", "[unit][integrators]") {
  const int order = GENERATE(2, 4);
  System system;
  const MassProperties wheel{1.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()};
  Body &a = system.add_body("a", wheel), &b = system.add_body("b", wheel, {Vec3(0, 0, 1), {}});
  system.add<Revolute>("A", a, system.ground(), pose_at({0, 0, 0}));
  system.add<Revolute>("B", b, system.ground(), pose_at({0, 0, 1}));
  GenericLock& clutch = system.add<GenericLock>("clutch", a, b, pose_at({0, 0, 0.5}), Mask::e3);
  clutch.hold();
  clutch.set_active_at_start(false);
  a.start.w = {0, 0, 2};
  Dynamics dynamics = dynamics_of(system);
  StepLoop run(dynamics, std::make_unique<Rattle>(order), {.step = 1.0 / 128});
  run.add_event({.name = "close", .at = 0.5, .activate = {"clutch"}});
  run.run_until(1);
  for (const Body* each : {&a, &b}) CHECK(body_twist(*each, run.state()).w.z() == Approx(1).epsilon(1e-10));
  const auto angle = [&](const Body& of) {
    const Quat e = body_pose(of, run.state()).q;
    return 2 * std::atan2(e.vec()[2], e.w);
  };
  CHECK(angle(a) == Approx(2 * 0.5 + 0.5).epsilon(1e-9));
  CHECK(angle(b) == Approx(0.5).epsilon(1e-9));
}

TEST_CASE("rattle rejects a damper by its name", "[unit][integrators]") {
  const int order = GENERATE(2, 4);
  RodPendulum pendulum;
  Marker& hook = pendulum.system.add_marker("hook", pendulum.system.body("rod"));
  Marker& anchor = pendulum.system.add_marker("anchor", pendulum.system.ground(), {{1, 0, 0}, {}});
  pendulum.system.add<SpringDamper>("spring", hook, anchor, SpringDamper::Options{.stiffness = 10, .free_length = 0.5});
  const auto begin = [&] {
    Dynamics dynamics = dynamics_of(pendulum.system);
    Rattle(order).begin(dynamics, pendulum.system.start());
  };
  CHECK_NOTHROW(begin());
  pendulum.system.add<SpringDamper>("dashpot", hook, anchor,
                                    SpringDamper::Options{.stiffness = 10, .damping = 0.1, .free_length = 0.5});
  testing::check_words(testing::message_of<ModelError>(begin),
                       {order == 2 ? "rattle2" : "rattle4", "force 'dashpot'", "depends on velocities", "dopri5"});
}

TEST_CASE("rattle rejects a joint that is driven by its speed", "[unit][integrators]") {
  RodPendulum pendulum;
  Body& disc = pendulum.system.add_body("disc", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  pendulum.system.add<Revolute>("motor", disc, pendulum.system.ground(), pose_at(Vec3::Zero(), Vec3(0, 0, 1)))
      .drive_speed(Axis::rz, laws::constant(2.0));
  Dynamics dynamics = dynamics_of(pendulum.system);
  testing::check_words(testing::message_of<ModelError>([&] { Rattle(2).begin(dynamics, pendulum.system.start()); }),
                       {"rattle2", "joint 'motor'", "dopri5"});
}

}  // namespace rattle_test
