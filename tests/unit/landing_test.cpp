// SPDX-License-Identifier: BSD-3-Clause
// Steps land on the jumps of built-in laws, and the stages before a jump see only what was before it.
#include <cmath>
#include <memory>
#include <string>

#include <lockstep/integrators.h>
#include <lockstep/laws.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"

namespace landing_test {

using namespace lockstep;

namespace {

std::unique_ptr<Integrator> method_named(const std::string& name) {
  if (name == "rk4") return std::make_unique<Rk4>();
  if (name == "dopri5") return std::make_unique<Dopri5>();
  if (name == "radau5") return std::make_unique<Radau5>();
  return std::make_unique<GeneralizedAlpha>();
}

/// A mass of 1 kg on a slide, pushed by a force law; its state at `end`, with steps of h (adaptive: at most).
State pushed(LawPtr<MotionLaw> force, double end, const std::string& method, double h) {
  System sys;
  Body& mass = sys.add_body("mass", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  Marker& P = sys.add_marker("P", mass);
  Marker& S = sys.add_marker("S", sys.ground());
  sys.add<Prismatic>("slide", P, S);
  sys.add<ForceMotor>("push", P, S, {.force = std::move(force)});
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  StepLoop run(dynamics, method_named(method), {.step = h, .tolerance = {1e-9, 1e-11}});
  run.run_until(end);
  State state = run.state();
  dynamics.to_slots(state);
  return state;
}

}  // namespace

TEST_CASE("piecewise constant forces are integrated exactly, jumps on and off the grid of steps",
          "[unit][simulation]") {
  const std::string method = GENERATE("rk4", "dopri5", "radau5", "generalized_alpha");
  const double first = GENERATE(0.3, 0.25, 0.123456789);
  CAPTURE(method, first);
  const auto law = laws::sequence({{first, laws::constant(1.0)}, {0.4, laws::constant(3.0)}, {1.0, laws::constant(-2.0)}});
  // a = 1 for `first`, 3 for 0.4, -2 for 0.1
  const double v1 = first, x1 = 0.5 * first * first;
  const double v2 = v1 + 1.2, x2 = x1 + 0.4 * v1 + 0.5 * 3 * 0.16;
  const double v3 = v2 - 0.2, x3 = x2 + 0.1 * v2 - 0.01;
  const State end = pushed(law, first + 0.5, method, 0.1);
  CHECK(std::abs(end.v[2] - v3) < 1e-10);
  CHECK(std::abs(end.q[2] - x3) < 1e-10);
}

TEST_CASE("a force that repeats with a jump each period loses nothing over fifty periods", "[unit][simulation]") {
  // y = t in each period of 0.2 s: a saw tooth from 0 to 0.2 N
  const State end = pushed(laws::repeat(laws::ramp(1.0), 0.2), 10.0, "rk4", 0.05);
  CHECK(std::abs(end.v[2] - 50 * 0.02) < 1e-10);
}

// A stone falls through a height, again and again thrown up there: t = sqrt(2 h/g) for each fall.
TEST_CASE("events are located in the dense output of implicit methods", "[unit][simulation]") {
  const std::string method = GENERATE("dopri5", "radau5", "generalized_alpha");
  CAPTURE(method);
  const double g = 9.81, height = 0.7;
  System sys({.gravity = {0, 0, -g}});
  Body& stone = sys.add_body("stone", shapes::box(1, {0.1, 0.2, 0.3}), {{0, 0, height}, {}});
  stone.start.w = {0.4, 3, 0.2};  // tumbling costs nothing
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  StepLoop run(dynamics, method_named(method), {.step = 0.05, .tolerance = {1e-9, 1e-11}});
  std::vector<double> met;
  Event floor;
  floor.name = "floor";
  floor.value = [](const Sample& s) { return s.state.slot_pose(0).x[2]; };
  floor.crossing = Event::Crossing::falling;
  floor.once = false;
  floor.tolerance = 1e-12;
  floor.change = [&](State& s) {
    met.push_back(s.t);
    s.q[2] = height;
    s.v.head<3>().setZero();
  };
  run.add_event(floor);
  run.run_until(3.0);
  REQUIRE(met.size() == 7);
  for (std::size_t i = 0; i < met.size(); ++i)
    CHECK(std::abs(met[i] - static_cast<double>(i + 1) * std::sqrt(2 * height / g)) < 1e-9);
}

}  // namespace landing_test
