// SPDX-License-Identifier: BSD-3-Clause
// Copies with links that are no masks, or whose markers laws move, in lanes along joints: their rows are written copy by
// copy. Against each mechanism alone in joint coordinates and in omega.
#include <cmath>

#include <lockstep/batch.h>
#include <lockstep/body.h>
#include <lockstep/couplings.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/copies_of.h"
#include "tests/support/lane_loops.h"
#include "tests/support/messages.h"

namespace tree_lanes_functions_test {

using namespace lockstep;
using namespace lockstep::test;
using lockstep::testing::check_words;

namespace {

/// A chain of three rods, whose tip a wire holds to the ground; its length is a law.
std::unique_ptr<System> wired(int k, double twist) {
  auto sys = chain(3, k, twist);
  Marker &tip = sys->add_marker("tip", sys->body("rod 2"), {Vec3(0.5, 0, 0), Quat{}}),
         &hook = sys->add_marker("hook", sys->ground(), {Vec3(1, 0, 2), Quat{}});
  const double length = std::sqrt(8.0);
  sys->add<Distance>("wire", tip, hook, laws::law([=](auto t) { return length + 0.1 * sin((2.0 + 0.1 * k) * t); }));
  return sys;
}

/// Two wheels on an arm, which a gear couples, and a screw beside them.
std::unique_ptr<System> geared(int k, double moment) {
  auto sys = std::make_unique<System>(System::Options{Vec3(0.1 * k, 0, -9.81)});
  const auto body = [&](const char* name, double x) -> Body& {
    return sys->add_body(name, {1.0 + 0.1 * k, Vec3(0.02, 0, 0), Vec3(0.1, 0.2, 0.25).asDiagonal()},
                         {Vec3(x, 0, 0), {}});
  };
  Body &arm = body("arm", 0), &one = body("one", 0), &two = body("two", 1);
  sys->add<Revolute>("shoulder", arm, sys->ground(), pose_at(Vec3(0, 0, 0), Vec3(0, 1, 0)));
  auto& a = sys->add<Revolute>("a", one, arm, pose_at(Vec3(0, 0, 0)));
  auto& b = sys->add<Revolute>("b", two, arm, pose_at(Vec3(1, 0, 0)));
  sys->add(std::make_unique<Gear>(across("mesh", {a, b}), 2.0));
  Body& nut = body("nut", 2);
  sys->add<Screw>("screw", nut, sys->ground(), pose_at(Vec3(2, 0, 0)), 0.3 + 0.02 * k);
  sys->add<TorqueMotor>("push", sys->add_marker("hub", one), sys->add_marker("stand", arm),
                        {.torque = laws::constant(moment)});
  return sys;
}

/// Two wheels of 1 and 4 kg m^2 on hinges; a moment shakes the first, which turns twice as fast as the other, backwards.
std::unique_ptr<System> shaken(int k) {
  auto sys = std::make_unique<System>();
  const auto wheel = [&](const char* name, double J, double x) -> Body& {
    return sys->add_body(name, {1.0, Vec3::Zero(), Vec3(J, J, J).asDiagonal()}, {Vec3(x, 0, 0), Quat{}});
  };
  Body &one = wheel("one", 1, 0), &two = wheel("two", 4, 1);
  auto& a = sys->add<Revolute>("a", one, sys->ground(), pose_at(Vec3(0, 0, 0)));
  auto& b = sys->add<Revolute>("b", two, sys->ground(), pose_at(Vec3(1, 0, 0)));
  sys->add(std::make_unique<Gear>(across("mesh", {a, b}), 2.0));
  const double A = 20000.0 + 100.0 * k;
  sys->add<TorqueMotor>("shaker", sys->add_marker("hub", one), sys->add_marker("stand", sys->ground()),
                        {.torque = laws::law([=](auto t) { return A * cos(20.0 * t); })});
  return sys;
}

}  // namespace

TEST_CASE("vectorised constraints of functions and of moving markers are those of the joints", "[unit][copies]") {
  const auto check = [](Family family) {
    const RateDifferences worst = differences(family, 1e-4, anywhere);
    CHECK(worst.n >= static_cast<int>(family.systems.size()) - 1);
    CHECK(worst.joint < 1e-10);
    CHECK(worst.omega < 1e-10);
  };
  SECTION("a wire") {
    check(Family(8, [](int k) { return wired(k, 0.7); }));
  }
  SECTION("a wire in a mechanism that is planar") {
    check(Family(7, [](int k) {
      auto sys = wired(k, 0);
      sys->set_planar(Plane{1});
      return sys;
    }));
  }
  SECTION("a gear, and a screw, whose function its joint leaves") {
    check(Family(8, [](int k) { return geared(k, 1); }));
  }
  SECTION("markers that move, on either body, beside locks of plain ones") {
    check(random_family(5, [](inputs::RandomMechanism& m) {
      m.link(0, -1, Mask::xyz), m.link(1, 0, Mask::xyz), m.link(2, 1, Mask::xyz | Mask::e1 | Mask::e2);
      m.link(3, 2, Mask::xyz), m.link(4, 3, Mask::xyz);
      m.link(-1, 1, Mask::x | Mask::z, oracle::kUP);
      m.link(2, -1, Mask::y);
      m.link(4, 0, Mask::x | Mask::e2, oracle::kUS | oracle::kQP);
    }));
  }
}

TEST_CASE("instances with functions run vectorised as they run alone", "[unit][copies]") {
  const auto method = GENERATE(as<std::string>{}, "dop853", "dopri5", "rk4");
  const bool gears = GENERATE(false, true);
  CAPTURE(method, gears);
  Family family(10, [&](int k) { return gears ? geared(k, 5.0 + k) : wired(k, 0.7); });
  // At the start both wheels are at rest, and errors of steps are roundings, from which the lengths of steps follow.
  check_lanes_against_alone(family, method, 0.8, {.q = 1e-8, .v = 1e-7, .violation = 1e-9, .steps = gears ? 2 : 0});
}

// J1 + J2/4 = 2: at 20 rad/s a moment of 20000 cos(20 t) N m makes 25 rad of each half swing. See counted_turns_test.
TEST_CASE("vectorised gears count all revolutions of a step", "[unit][copies]") {
  Family family(8, [](int k) { return shaken(k); });
  CopiesOptions options;
  options.formulation = Formulation::joint, options.integrator = "dop853", options.tolerance = {1e-1, 1e-9};
  const std::vector<State> starts = family.starts();
  for (const char* method : {"dop853", "rk4"}) {
    CAPTURE(method);
    options.integrator = method, options.step = options.integrator == "rk4" ? 0.2 : 0.0;
    const RunEnds free = ends_of(family, starts, 2.0, options, true);
    for (std::size_t k = 0; k < starts.size(); ++k) {
      INFO(k << ": " << free.reports[k].error);
      REQUIRE(free.reports[k].finished);
      CHECK_FALSE(free.reports[k].alone);  // its wheels stand: velocities are met to the round-off of what turns
      const State& end = free.states[k];
      const CountedAngle& angle = *family.systems[k]->counted_angles().front();
      CHECK(std::abs(angle.expected({end.s.data(), static_cast<std::size_t>(end.s.size())})) > kTwoPi);
      CHECK(Dynamics(*family.systems[k], std::make_unique<SchurSolver>()).violation(end) < 1e-8);
    }
  }
}

}  // namespace tree_lanes_functions_test
