// Steps land on the jumps of built-in laws, and the stages before a jump see only what was before it.
#include <cmath>
#include <memory>

#include "framework/lockstep.h"
#include "motionlaws/repeat.h"
#include "motionlaws/sequence.h"
#include "tests/support/catch.h"

using namespace lockstep;

namespace {

/// A mass of 1 kg on a slide, pushed by a force law; its state at `end`, with rk4 at h or dopri5.
State pushed(LawPtr<MotionLaw> force, double end, bool adaptive, double h) {
  System sys;
  Body& mass = sys.add_body("mass", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  Marker& P = sys.add_marker("P", mass);
  Marker& S = sys.add_marker("S", sys.ground());
  sys.add<Prismatic>("slide", P, S);
  sys.add<ForceMotor>("push", P, S, {.force = std::move(force)});
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  std::unique_ptr<Integrator> method;
  if (adaptive)
    method = std::make_unique<Dopri5>();
  else
    method = std::make_unique<Rk4>();
  Simulation run(dynamics, std::move(method), {.step = h, .tolerance = {1e-9, 1e-11}});
  run.run_until(end);
  return run.state();
}

}  // namespace

TEST_CASE("piecewise constant forces are integrated exactly, jumps on and off the grid of steps",
          "[unit][simulation]") {
  const bool adaptive = GENERATE(false, true);
  const double first = GENERATE(0.3, 0.25, 0.123456789);
  CAPTURE(adaptive, first);
  const auto law = sequence({{first, constant(1.0)}, {0.4, constant(3.0)}, {1.0, constant(-2.0)}});
  // a = 1 for `first`, 3 for 0.4, -2 for 0.1
  const double v1 = first, x1 = 0.5 * first * first;
  const double v2 = v1 + 1.2, x2 = x1 + 0.4 * v1 + 0.5 * 3 * 0.16;
  const double v3 = v2 - 0.2, x3 = x2 + 0.1 * v2 - 0.01;
  const State end = pushed(law, first + 0.5, adaptive, 0.1);
  CHECK(std::abs(end.v[2] - v3) < 1e-10);
  CHECK(std::abs(end.q[2] - x3) < 1e-10);
}

TEST_CASE("a force that repeats with a jump each period loses nothing over fifty periods", "[unit][simulation]") {
  // y = t in each period of 0.2 s: a saw tooth from 0 to 0.2 N
  const State end = pushed(repeat(ramp(1.0), 0.2), 10.0, false, 0.05);
  CHECK(std::abs(end.v[2] - 50 * 0.02) < 1e-10);
}
