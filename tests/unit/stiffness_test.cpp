// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"

namespace stiffness_test {

using namespace lockstep;

namespace {

/// A mass of 1 kg on a slide, stiffness and damping to the ground, let go 0.1 m off; what the method says of 0.5 s.
SimulationReport pulled(std::unique_ptr<Integrator> method, double stiffness, double damping, double tolerance,
                        Stabilization::Kind kind = Stabilization::Kind::project) {
  System sys;
  Body& mass = sys.add_body("mass", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()}, {{0, 0, 0.1}, {}});
  Marker& P = sys.add_marker("P", mass);
  Marker& S = sys.add_marker("S", sys.ground());
  Marker& anchor = sys.add_marker("anchor", sys.ground(), {{0, 0, -1}, {}});
  sys.add<Prismatic>("slide", P, S);
  sys.add<SpringDamper>("spring", P, anchor,
                        SpringDamper::Options{.stiffness = stiffness, .damping = damping, .free_length = 1});
  Dynamics dynamics(sys, std::make_unique<DenseSolver>(), {Formulation::omega, {.kind = kind}});
  StepLoop run(dynamics, std::move(method), {.tolerance = {tolerance, 1e-2 * tolerance}});
  return run.run_until(0.5);
}
SimulationReport pulled(const char* method, double stiffness, double damping, double tolerance) {
  return pulled(builtin_registry().integrators.make(method, Params{}, nullptr, "run.integrator"), stiffness, damping,
                tolerance);
}

/// A method that takes every step for one that damped modes limit.
struct TakesForStiff final : Integrator {
  IntegratorInfo info() const override { return method.info(); }
  void begin(Dynamics& dynamics, const State& state) override { method.begin(dynamics, state); }
  StepReport step(Dynamics& dynamics, State& state, double h) override {
    StepReport report = method.step(dynamics, state, h);
    report.stiff = true;
    return report;
  }
  Dopri5 method;
};

}  // namespace

TEST_CASE("stiff are damped modes that keep the steps at the limit of stability", "[unit][integrators]") {
  const auto look = [](double h_rate, double damped, int steps) {
    StiffnessWatch watch(3.3);
    for (int i = 0; i < steps; ++i) watch.add(0.1, 4.0, 4.0 * 100 * h_rate * h_rate, -4.0 * 10 * damped * h_rate);
    return watch.stiff();
  };
  CHECK(look(3.3, 1, 15));
  CHECK_FALSE(look(3.3, 1, 14));
  CHECK_FALSE(look(3.3, 0, 15));   // swings
  CHECK_FALSE(look(3.3, -1, 15));  // grows
  CHECK_FALSE(look(1.5, 1, 15));   // is followed
}

TEST_CASE("a stiff spring is called stiff", "[unit][integrators]") {
  const char* method = GENERATE("dopri5", "dop853");
  const double tolerance = GENERATE(1e-3, 1e-6, 1e-8);
  CAPTURE(method, tolerance);
  CHECK(pulled(method, 4e4, 4e4, tolerance).stiff_since < 0.1);  // overdamped, fast mode 4e4 1/s
}

TEST_CASE("an undamped fast oscillation is not called stiff", "[unit][integrators]") {
  const char* method = GENERATE("dopri5", "dop853");
  const double tolerance = GENERATE(1e-2, 1e-4, 1e-7);
  CAPTURE(method, tolerance);
  CHECK(std::isinf(pulled(method, 1e6, 0, tolerance).stiff_since));  // 1000 rad/s
  CHECK(std::isinf(pulled(method, 1e6, 5, tolerance).stiff_since));  // damped by a 400th
}

TEST_CASE("a motion without damped modes is not called stiff, with any method", "[unit][integrators]") {
  using Kind = Stabilization::Kind;
  const auto says = [](double damping, Kind kind) {
    return std::isfinite(pulled(std::make_unique<TakesForStiff>(), 1e3, damping, 1e-6, kind).stiff_since);
  };
  CHECK_FALSE(says(0, Kind::project));
  CHECK(says(1, Kind::project));
  CHECK(says(0, Kind::baumgarte));
}

}  // namespace stiffness_test
