// SPDX-License-Identifier: BSD-3-Clause
// Counted angles: what they are at the start, along motions with few steps, and where they have no value.
#include <lockstep/detail/counted_angle.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include <lockstep/author/registry.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include <lockstep/system.h>
#include "tests/support/catch.h"

namespace counted_angle_test {

using namespace lockstep;

namespace {

/// A wheel on a hinge about z, without gravity.
struct Wheel {
  System system;
  Body& body = system.add_body("wheel", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  Lock& hinge = system.add<Revolute>("A", body, system.ground(), pose_at(Vec3::Zero()));
  const CountedAngle& angle = system.count(*hinge.pairs().front().first, *hinge.pairs().front().second, 2);

  /// By rk4 in fixed steps of h, from a speed; returns the angle at t.
  double after(double speed, double h, double t, Formulation formulation) {
    Dynamics dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation});
    StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = h});
    State start = system.start();
    start.set_slot_twist(0, {Vec3::Zero(), Vec3(0, 0, speed)});
    loop.set_state(start);
    loop.run_until(t);
    return angle.value(dynamics.inputs(loop.state()));
  }
};

}  // namespace

TEST_CASE("a counted angle makes several revolutions in a step, in either formulation", "[unit][angles]") {
  for (const Formulation formulation : {Formulation::omega, Formulation::joint}) {
    Wheel wheel;
    // of quaternions only steps within a turn or so are any good; along a joint they may be as long as one likes
    const double h = formulation == Formulation::joint ? 3.7 : 0.01;
    const double off = formulation == Formulation::joint ? 1e-9 : 1.5e-5;  // 740 steps of (w h / 2)^5 / 60 each
    CHECK(wheel.after(13.0, h, 7.4, formulation) == Approx(13.0 * 7.4).margin(off));
    CHECK(wheel.after(-13.0, h, 7.4, formulation) == Approx(-13.0 * 7.4).margin(off));
  }
}

TEST_CASE("half a revolution is counted as a positive angle, in both directions", "[unit][angles]") {
  for (const double given : {kPi, -kPi}) {
    Wheel wheel;
    wheel.body.home.q = Quat::from(std::cos(0.5 * given), Vec3(0, 0, std::sin(0.5 * given)));
    Dynamics dynamics(wheel.system, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega});
    State start = wheel.system.start();
    const Inputs in = dynamics.inputs(start);
    wheel.angle.set(in, 0, start.s);
    CHECK(wheel.angle.value(dynamics.inputs(start)) == Approx(kPi));
    wheel.angle.set(in, 3 * kPi, start.s);
    CHECK(wheel.angle.value(dynamics.inputs(start)) == Approx(3 * kPi));
    wheel.angle.set(in, -kPi, start.s);
    CHECK(wheel.angle.value(dynamics.inputs(start)) == Approx(-kPi));
  }
}

TEST_CASE("a million revolutions leave the angle its digits", "[unit][angles]") {
  Wheel wheel;
  const double speed = 1e6 * kTwoPi + 0.3;
  const double end = wheel.after(speed, 0.1, 1.0, Formulation::joint);
  CHECK(std::remainder(end - 0.3, kTwoPi) == Approx(0).margin(4e-9));  // the ulp of the sum is 9e-10
  CHECK(std::round((end - 0.3) / kTwoPi) == 1e6);
}

TEST_CASE("a counted angle changes neither coordinates nor velocities", "[unit][angles]") {
  const Formulation formulation = GENERATE(Formulation::omega, Formulation::joint);
  const auto end_of = [formulation](bool counted) {
    System s({.gravity = Vec3(0, -9.81, 0)});
    Body& a = s.add_body("a", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
    Body& b = s.add_body("b", shapes::rod(1.0, Vec3(1, 0, 0), Vec3(2, 0.3, 0)));
    s.add<Revolute>("A", a, s.ground(), pose_at(Vec3::Zero()));
    Lock& joint = s.add<Revolute>("B", b, a, pose_at(Vec3(1, 0, 0)));
    if (counted) s.count(*joint.pairs().front().first, *joint.pairs().front().second, 2);
    s.add<PointOnLine>("C", b, s.ground(),
                       pose_at(Vec3(2, 0.3, 0), Vec3(1, 0, 0)));  // a slider-crank, whose loop it closes
    Dynamics dynamics(s, std::make_unique<SchurSolver>(), {.formulation = formulation});
    StepLoop loop(dynamics, std::make_unique<Dopri5>(), {.tolerance = tolerance_of(1e-8)});
    loop.run_until(3);
    return loop.state();
  };
  const State with = end_of(true), without = end_of(false);
  CHECK(with.q == without.q);
  CHECK(with.v == without.v);
  CHECK(with.s.size() == without.s.size() + 3);
}

// Evaluations, too: no method takes a corrected angle for a change of the motion.
TEST_CASE("a counted angle costs no method evaluations", "[unit][angles]") {
  const std::string method = GENERATE("generalized_alpha", "rattle2", "rattle4", "rk4", "semi_implicit_euler");
  CAPTURE(method);
  const auto end_of = [&](bool counted) {
    System s({.gravity = Vec3(0, -9.81, 0)});
    Body& a = s.add_body("a", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
    Lock& joint = s.add<Revolute>("A", a, s.ground(), pose_at(Vec3::Zero()));
    if (counted) s.count(*joint.pairs().front().first, *joint.pairs().front().second, 2);
    Dynamics dynamics(s, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega});
    StepLoop loop(dynamics, builtin_registry().integrators.make(method, Params{}, nullptr, "run.integrator"),
                  {.step = 1e-3});
    loop.run_until(0.5);
    return std::make_pair(loop.state(), dynamics.work().evaluations);
  };
  const auto with = end_of(true), without = end_of(false);
  CHECK(with.first.q == without.first.q);
  CHECK(with.first.v == without.first.v);
  CHECK(with.second == without.second);
}

TEST_CASE("all that count one angle share it", "[unit][angles]") {
  Wheel wheel;
  const auto [p, s] = wheel.hinge.pairs().front();
  CHECK(&wheel.system.count(*p, *s, 2) == &wheel.angle);
  CHECK(wheel.system.counted(*p, *s, 2) == &wheel.angle);
  CHECK(wheel.system.counted(*p, *s, 0) == nullptr);
  CHECK(wheel.system.counted_angles().size() == 1);
}

TEST_CASE("an angle that has no value on the way is in doubt", "[unit][angles]") {
  System s;
  Body& b = s.add_body("b", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  const Vec3 axis = Vec3(1, 0.01, 0).normalized();
  Lock& hinge = s.add<Revolute>("A", b, s.ground(), pose_at(Vec3::Zero(), axis));
  Marker& P = s.add_marker("P", b);
  Marker& S = s.add_marker("S", s.ground());
  (void)hinge;
  const CountedAngle& across = s.count(P, S, 1);  // e0 and e2 both come near zero after half a turn
  Dynamics dynamics(s, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 0.1});
  State start = s.start();
  start.set_slot_twist(0, {Vec3::Zero(), 4 * axis});
  loop.set_state(start);
  const auto doubt = [&] {
    const State& now = loop.state();
    return across.doubt({now.s.data(), static_cast<std::size_t>(now.s.size())});
  };
  loop.run_until(0.6);
  CHECK(doubt() < 0.01);
  loop.run_until(1.0);
  CHECK(doubt() > 0.5 * kPi);
}

}  // namespace counted_angle_test
