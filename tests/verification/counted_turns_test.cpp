// SPDX-License-Identifier: BSD-3-Clause
// Links that count turns (gears, belts, differentials) along joints, where steps make many turns.
#include <cmath>

#include <lockstep/assembly.h>
#include <lockstep/author/force.h>
#include <lockstep/body.h>
#include <lockstep/couplings.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace counted_turns_test {

using namespace lockstep;
using testing::check_words, testing::message_of;

namespace {

/// A moment about the first body's z axis, A cos(W t).
class Shaker final : public Force {
 public:
  Shaker(double A, double W) : Force("shaker"), A_(A), W_(W) {}
  std::string_view type() const override { return "shaker"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { out.torque(0, Vec3(0, 0, A_ * std::cos(W_ * in.t))); }

 private:
  double A_, W_;
};

/// Two wheels of 1 and 4 kg m^2; the second turns half as fast, the other way. `driven`: the first by a law.
struct Wheels {
  System system;
  explicit Wheels(bool driven = false) {
    const auto wheel = [&](const char* name, double J, double x) -> Body& {
      return system.add_body(name, {1.0, Vec3::Zero(), Vec3(J, J, J).asDiagonal()}, {Vec3(x, 0, 0), Quat{}});
    };
    Body &one = wheel("one", 1, 0), &two = wheel("two", 4, 1);
    auto& a = system.add<Revolute>("a", one, system.ground(), pose_at(Vec3(0, 0, 0)));
    auto& b = system.add<Revolute>("b", two, system.ground(), pose_at(Vec3(1, 0, 0)));
    if (driven) a.drive(Axis::rz, laws::polynomial({0.0, 1.0}));
    system.add(std::make_unique<Gear>(across("mesh", {a, b}), 2.0));
  }
};

Dynamics along_joints(System& system) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
}

}  // namespace

TEST_CASE("joints with counted revolutions use joint coordinates as omega, in far fewer steps",
          "[verification][joint]") {
  const auto scene = GENERATE(as<std::string>{}, "gear_train", "differential", "belt");
  CAPTURE(scene);
  const auto run = [&](Formulation formulation) {
    return run_scene(scene_path(scene), [&](RunSettings& r) { r.formulation = formulation; });
  };
  const SceneRun automatic = run(Formulation::automatic), omega = run(Formulation::omega);
  CHECK(5 * automatic.report.steps < omega.report.steps);
  for (const ColumnError& e : compare(automatic.table, omega.table)) {
    CAPTURE(e.name);
    CHECK(e.error <= 1e-8 * std::max(1.0, e.size));
  }
}

// J1 + J2/4 = 2: w = 500 sin(20 t) rad/s, 25 rad in each half swing; a step of dop853 sees most of one at this tolerance.
TEST_CASE("a wheel with many revolutions in one or two steps is counted correctly", "[verification][joint]") {
  for (const double relative : {1e-1, 1e-3, 1e-6}) {
    CAPTURE(relative);
    Wheels wheels;
    wheels.system.add(std::make_unique<Shaker>(2 * 500.0 * 20.0, 20.0));
    Dynamics dynamics = along_joints(wheels.system);
    State start = wheels.system.start();
    dynamics.to_formulation(start);
    REQUIRE(start.coordinates);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {relative, 1e-9}});
    loop.set_state(start);
    double worst = 0;
    for (int k = 1; k <= 40; ++k) {
      loop.run_until(0.05 * k);
      State now = loop.state();
      CHECK(dynamics.violation(now) < 1e-9);
      keep_worst(worst, std::abs(now.q[0] + 2.0 * now.q[1]));
    }
    CHECK(worst < 1e-8);
    const double angle = 25.0 * (1.0 - std::cos(40.0));
    CHECK(std::abs(loop.state().q[0] - angle) < 100 * relative);
  }
}

namespace {

/// Moments about z of the first two bodies that grow alike with the time, 120 N m/s.
class Runup final : public Force {
 public:
  Runup() : Force("runup") {}
  std::string_view type() const override { return "runup"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override {
    for (const int slot : {0, 1}) out.torque(slot, Vec3(0, 0, 120 * in.t));
  }
};

}  // namespace

// Two wheels on one axis, each on a hinge of the ground, speed up alike: 60 t^2 rad/s. A third is geared to the turn of one
// against the other, a pair that no joint has: it is the difference of their angles and stays 0, however long the steps.
TEST_CASE("the relative rotation of two bodies in the plane is the difference of their angles",
          "[verification][joint]") {
  System system;
  system.set_planar(Plane{2});
  const Pose axis = pose_at(Vec3::Zero());
  const auto wheel = [&](const char* name) -> Body& {
    Body& body = system.add_body(name, MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 1).asDiagonal()});
    system.add<Revolute>(std::string("hinge ") + name, body, system.ground(), axis);
    return body;
  };
  Body &one = wheel("one"), &two = wheel("two"), &third = wheel("third");
  CoupledPairs coupled("mesh");
  coupled.pairs = {{&system.add_marker_at("on one", one, axis), &system.add_marker_at("on two", two, axis)},
                   system.link("hinge third").pairs().front()};
  system.add(std::make_unique<Gear>(coupled, 2.0));
  system.add(std::make_unique<Runup>());
  Dynamics dynamics = along_joints(system);
  State start = system.start();
  dynamics.to_formulation(start);
  REQUIRE(start.coordinates);
  StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-8, 1e-8}});
  loop.set_state(start);
  loop.run_until(10);
  CHECK(loop.report().steps <= 12);
  State end = loop.state();
  dynamics.to_slots(end);
  CHECK(body_twist(one, end).w[2] == Approx(6000).epsilon(1e-9));
  CHECK(body_twist(two, end).w[2] == Approx(6000).epsilon(1e-9));
  CHECK(std::abs(body_twist(third, end).w[2]) < 1e-9);
}

// The steps are far too long for the moment, and the motion is not that of the equations; but it is one motion.
TEST_CASE("fixed steps of many revolutions count all of them", "[verification][joint]") {
  Wheels wheels;
  wheels.system.add(std::make_unique<Shaker>(2 * 500.0 * 20.0, 20.0));
  Dynamics dynamics = along_joints(wheels.system);
  State start = wheels.system.start();
  dynamics.to_formulation(start);
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 0.2});
  loop.set_state(start);
  double most = 0;
  for (int k = 1; k <= 10; ++k) {
    const double before = loop.state().q[0];
    loop.run_until(0.2 * k);
    State now = loop.state();
    most = std::max(most, std::abs(now.q[0] - before));
    CHECK(dynamics.violation(now) < 1e-9);
    CHECK(now.q[0] + 2.0 * now.q[1] == Approx(0).margin(1e-9 * std::max(1.0, std::abs(now.q[0]))));
  }
  CHECK(most > kTwoPi);
}

TEST_CASE("joints with memory remain in omega, by name, except those with counted revolutions",
          "[verification][joint]") {
  const auto why = [](System& system) { return along_joints(system).why_not_joint(system.start().modes); };
  Wheels plain, driven(true);
  plain.system.setup(), driven.system.setup();
  CHECK(why(plain.system).empty());
  CHECK(why(driven.system).empty());
  const std::string path = message_of<ModelError>([] {
    run_scene(scene_path("path_follower"), [](RunSettings& r) { r.until = 0.05, r.formulation = Formulation::joint; });
  });
  check_words(path, {"keeps a memory", "ways"});
}

}  // namespace counted_turns_test
