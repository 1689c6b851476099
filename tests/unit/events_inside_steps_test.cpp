// SPDX-License-Identifier: BSD-3-Clause
// Events and contacts inside long steps: turning points beside the ends of a step, several turns in a step, outputs.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>
#include <lockstep/laws.h>
#include <lockstep/lockstep.h>
#include "framework/dynamics/simulate/guard_finder.h"
#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace events_inside_steps_test {

using namespace lockstep;

namespace {

std::unique_ptr<Integrator> method_named(const std::string& name) {
  if (name == "rk4") return std::make_unique<Rk4>();
  if (name == "rattle2") return std::make_unique<Rattle>(2);
  if (name == "dopri5") return std::make_unique<Dopri5>();
  if (name == "dop853") return std::make_unique<Dop853>();
  if (name == "radau5") return std::make_unique<Radau5>();
  return std::make_unique<GeneralizedAlpha>();
}

/// First instant after `from` at which g, of a closed form, becomes >= 0: by small steps and halving.
double first_rise(const std::function<double(double)>& g, double from, double step) {
  double t = from;
  while (g(t + step) < 0) t += step;
  double a = t, b = t + step;
  for (int k = 0; k < 60; ++k) (g(0.5 * (a + b)) < 0 ? a : b) = 0.5 * (a + b);
  return b;
}

/// A body that turns about z by 10 rad/s and drifts along x by `drift`; its tip is 1 m from its centre.
struct Rotor {
  System system;
  const Marker* tip = nullptr;
  explicit Rotor(double drift) {
    Body& b = system.add_body("b", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
    b.start.w = {0, 0, 10}, b.start.v = {drift, 0, 0};
    tip = &system.add_marker("tip", b, pose_at({1, 0, 0}));
  }
  std::function<double(const Sample&)> x() const {
    return [](const Sample& s) {
      const Pose p = s.state.slot_pose(0);
      return p.x[0] + (rotation(p.q) * Vec3(1, 0, 0))[0];
    };
  }
};

}  // namespace

// z = v t - g t^2/2 passes apex - d at (v -+ sqrt(2 g d))/g; the steps that ballistic flight allows are as long as the
// run.
TEST_CASE("event: a thrown body meets every level below its apex, wherever the apex lies in a step", "[unit][events]") {
  const std::string method = GENERATE("dopri5", "dop853", "radau5");
  const double tolerance = GENERATE(1e-6, 1e-3);
  const auto crossing = GENERATE(Event::Crossing::rising, Event::Crossing::falling);
  for (const double v : {10.0, 20.0, 30.0})
    for (const double d : {0.3, 0.03, 3e-3, 1e-4, 1e-6})
      for (const double end : {2.02, 2.2, 2.9, 8.0}) {
        CAPTURE(method, tolerance, v, d, end);
        Stone stone;
        Dynamics dynamics = dynamics_of(stone.system);
        StepLoop run(dynamics, method_named(method), {.tolerance = {tolerance, 1e-2 * tolerance}});
        run.set_state(stone.thrown(v));
        Event event{.name = "level", .crossing = crossing, .stop = true};
        event.value = [level = v * v / 20 - d](const Sample& s) { return s.state.slot_pose(0).x[2] - level; };
        run.add_event(event);
        run.run_until(end * v / 10);
        CHECK(run.report().stopped_by == "level");
        const double half = std::sqrt(d / 5);
        const double when = v / 10 + (crossing == Event::Crossing::rising ? -half : half);
        CHECK(std::abs(run.state().t - when) < 1e-8 + 1e-9 / half);
      }
}

TEST_CASE("event: crossings in both directions are found if a body rotates by many radians in a step",
          "[unit][events]") {
  const std::string method = GENERATE("dopri5", "dop853", "radau5");
  CAPTURE(method);
  SECTION("every passage of a tip") {
    const double margin = method == "radau5" ? 0.01 : 1e-5;  // s; its steps of more than two radians lose phase
    for (const double level : {0.0, 0.5, 0.99, 0.9999}) {
      CAPTURE(level);
      Rotor rotor(0);
      rotor.system.add<Revolute>("A", rotor.system.body("b"), rotor.system.ground(), pose_at({0, 0, 0}));
      Dynamics dynamics = dynamics_of(rotor.system, {Formulation::automatic, {}});
      StepLoop run(dynamics, method_named(method), {.tolerance = {1e-9, 1e-11}});
      std::vector<double> met;
      Event event{.name = "level", .crossing = Event::Crossing::rising, .once = false};
      event.value = [x = rotor.x(), level](const Sample& s) { return x(s) - level; };
      event.change = [&](State& s) { met.push_back(s.t); };
      run.add_event(event);
      run.run_until(20);
      const double passages = std::floor((200 + std::acos(level)) / (2 * kPi));  // at (2 pi k - acos(level))/10
      REQUIRE(met.size() == static_cast<std::size_t>(passages));
      for (std::size_t k = 0; k < met.size(); ++k)
        CHECK(std::abs(met[k] - (2 * kPi * static_cast<double>(k + 1) - std::acos(level)) / 10) < margin);
    }
  }
  SECTION("the first one of a tip that drifts") {
    const auto g = [](double t) { return std::cos(10 * t) + 0.01 * t - 1.05; };
    Rotor rotor(0.01);
    Dynamics dynamics = dynamics_of(rotor.system, {Formulation::automatic, {}});
    StepLoop run(dynamics, method_named(method), {.tolerance = {1e-9, 1e-11}});
    Event event{.name = "level", .crossing = Event::Crossing::rising, .stop = true};
    event.value = [x = rotor.x()](const Sample& s) { return x(s) - 1.05; };
    run.add_event(event);
    run.run_until(20);
    CHECK(run.report().stopped_by == "level");
    CHECK(std::abs(run.state().t - first_rise(g, 0, 1e-4)) < 1e-4);  // 5.02434 s; it grazes the level
  }
}

// The rope from (-10, 0) to the tip at (0.01 t + cos 10 t, sin 10 t) is 11.05 m long.
TEST_CASE("contact: a rope is met if the body on it rotates by many radians in a step", "[unit][events]") {
  const std::string method = GENERATE("dopri5", "dop853", "radau5");
  CAPTURE(method);
  Rotor rotor(0.01);
  System& system = rotor.system;
  Marker& hook = system.add_marker("hook", system.ground(), pose_at({-10, 0, 0}));
  system.add<Distance>("rope", system.marker("tip"), hook, 11.05).set_unilateral({.below = true});
  Dynamics dynamics = dynamics_of(system, {Formulation::automatic, {}});
  StepLoop run(dynamics, method_named(method), {.tolerance = {1e-9, 1e-11}});
  struct First final : Observer {
    double t = 0;
    void jumped(const Sample& s) override { t = t > 0 ? t : s.state.t; }
  } first;
  run.add_observer(first);
  run.run_until(8);
  const auto g = [](double t) { return std::hypot(10 + 0.01 * t + std::cos(10 * t), std::sin(10 * t)) - 11.05; };
  CHECK(std::abs(first.t - first_rise(g, 0, 1e-4)) < 1e-4);
}

// y = exp(-((t - 3.3)/0.05)^2) is above 0.5 from 3.3 - 0.05 sqrt(ln 2) on; nothing but the law limits the step.
TEST_CASE("event: a pulse of a law that moves all is met", "[unit][events]") {
  const double output = GENERATE(0.0, 0.01);
  const std::string method = GENERATE("dopri5", "dop853");
  CAPTURE(output, method);
  const Registry registry = builtin_registry();
  System system;
  Body& b = system.add_body("b", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  system.add<Prismatic>("A", b, system.ground(), pose_at({0, 0, 0}))
      .drive(Axis::z, registry.laws.make("formula", Params{{"y", "=exp(-((t-3.3)/0.05)^2)"}}, &registry, "law"));
  Dynamics dynamics = dynamics_of(system, {Formulation::automatic, {}});
  StepLoop run(dynamics, method_named(method), {.output = output});
  Event event{.name = "high", .crossing = Event::Crossing::rising, .stop = true};
  event.value = [](const Sample& s) { return s.state.slot_pose(0).x[2] - 0.5; };
  run.add_event(event);
  run.run_until(10);
  CHECK(run.report().stopped_by == "high");
  CHECK(std::abs(run.state().t - (3.3 - 0.05 * std::sqrt(std::log(2.0)))) < 1e-8);
}

TEST_CASE("event: no output lies beyond an event that did not fire", "[unit][events]") {
  const std::string method = GENERATE("dopri5", "radau5", "generalized_alpha");
  const double width = GENERATE(1e-2, 1e-4, 1e-7);
  CAPTURE(method, width);
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, method_named(method),
               {.step = method == "generalized_alpha" ? 0.5 : 0, .output_times = {0.1, 0.7, 0.731, 0.9}});
  Event event{.name = "spike", .crossing = Event::Crossing::rising, .stop = true};
  event.value = [=](const Sample& s) { return std::abs(s.state.t - 0.731) < width ? 1.0 : -1.0; };
  run.add_event(event);
  run.run_until(1);
  CHECK(run.report().stopped_by == "spike");
  CHECK(std::abs(run.state().t - (0.731 - width)) < 2e-9);
}

// The apex, 5 m at 1 s, lies inside the step from 0.9 to 1.2 s: 4.97 m is passed at 1 -+ sqrt(0.006) s.
TEST_CASE("event: a method without dense output finds crossings in both directions in a step", "[unit][events]") {
  const std::string method = GENERATE("rk4", "rattle2");
  const auto crossing = GENERATE(Event::Crossing::rising, Event::Crossing::falling, Event::Crossing::any);
  Stone stone;
  Dynamics dynamics = dynamics_of(stone.system);
  StepLoop run(dynamics, method_named(method), {.step = 0.3});
  run.set_state(stone.thrown(10));
  Event event{.name = "level", .crossing = crossing, .stop = true};
  event.value = [](const Sample& s) { return s.state.slot_pose(0).x[2] - 4.97; };
  run.add_event(event);
  run.run_until(3);
  CHECK(run.report().stopped_by == "level");
  const double half = std::sqrt(0.006);
  CHECK(std::abs(run.state().t - (crossing == Event::Crossing::falling ? 1 + half : 1 - half)) < 1e-8);
}

// The rod's centre stays at half its length from the hinge, but not along the cubic; it hangs where theta = 0.
TEST_CASE("event: a condition that has a value on the constraints alone is met by rk4", "[unit][events]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoop run(dynamics, method_named("rk4"), {.step = 0.05});
  Event event{.name = "low", .crossing = Event::Crossing::falling, .stop = true};
  event.value = [](const Sample& s) {
    const Vec3 x = s.state.slot_pose(0).x;
    return std::abs(x.norm() - 0.5 * RodPendulum::kLength) < 1e-8 ? x[0] : std::nan("");
  };
  run.add_event(event);
  run.run_until(1);
  CHECK(run.report().stopped_by == "low");
  CHECK(std::abs(pendulum.theta(run.state().t)) < 1e-4);
}

// A wheel of 1000 rad/s on a hinge beside a stone that is thrown: steps of hundreds of parts, of which few are looked
// at while the stone is far from its level. Another one, 300 m up, is as far at all times.
TEST_CASE("event: a condition far from zero is evaluated rarely, however fast a body rotates", "[unit][events]") {
  const bool meets = GENERATE(false, true), beside_another = GENERATE(false, true);
  Stone stone;
  System& system = stone.system;
  Body& wheel = system.add_body("wheel", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  wheel.start.w = {0, 0, 1000};
  system.add<Revolute>("A", wheel, system.ground(), pose_at({0, 0, 0}));
  Dynamics dynamics = dynamics_of(system, {Formulation::automatic, {}});
  StepLoop run(dynamics, method_named("dopri5"));
  State start = system.start();
  start.v[2] = 10;
  run.set_state(start);
  long asked = 0;
  Event event{.name = "level", .stop = true};
  event.value = [&, level = meets ? 4.9 : 100.0](const Sample& s) {
    return ++asked, s.state.slot_pose(0).x[2] - level;
  };
  run.add_event(event);
  Event farther{.name = "farther"};
  farther.value = [](const Sample& s) { return s.state.slot_pose(0).x[2] - 300; };
  if (beside_another) run.add_event(farther);
  run.run_until(2);
  CHECK((run.report().stopped_by == "level") == meets);
  if (meets) CHECK(std::abs(run.state().t - (1 - std::sqrt(0.02))) < 1e-8);
  if (!meets) CHECK(asked < 80 * run.report().steps);
}

// Four parts of a step, and one look beside an end of it at times.
TEST_CASE("event: a condition is evaluated about five times per step if no body rotates far", "[unit][events]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  StepLoop run(dynamics, method_named(GENERATE("dopri5", "dop853", "radau5")), {.tolerance = {1e-9, 1e-11}});
  long asked = 0;
  Event event{.name = "far"};
  event.value = [&](const Sample& s) { return ++asked, s.state.slot_pose(0).x[2] - 100; };
  run.add_event(event);
  run.run_until(5);
  CHECK(run.report().steps > 20);
  CHECK(asked <= 6 * run.report().steps + 2);
}

TEST_CASE("event: an extremum towards zero is followed as far as it may reach zero", "[unit][events]") {
  const double turn = GENERATE(0.01, 0.3, 0.5, 0.83, 0.999);
  const double depth = GENERATE(1e-3, 1e-6, 1e-9);
  for (const double sign : {1.0, -1.0})
    for (const double side : {1.0, -1.0}) {  // -1: beyond zero at its lowest
      int asked = 0;
      const auto g = [&](double t) {
        const double x = t - turn;
        return ++asked, sign * (x * x * (1 + 0.3 * x) + side * depth);
      };
      const double at = turn + 1e-3 * (turn < 0.5 ? 1 : -1);
      Sampled a{0, g(0)}, m{at, g(at)}, b{1, g(1)};
      if (!(sign * m.g > 0)) continue;
      asked = 0;
      CAPTURE(turn, depth, sign, side);
      CHECK(comes_to_zero(a, m, b, 1e-12, g) == (side < 0));
      CHECK(asked < 50);
      if (side > 0) continue;
      CHECK_FALSE(sign * m.g > 0);
      CHECK((a.t < m.t && m.t < b.t && sign * a.g > 0 && sign * b.g > 0));
    }
}

}  // namespace events_inside_steps_test
