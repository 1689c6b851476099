// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <cmath>

#include <lockstep/error.h>
#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/motions.h"
#include "tests/support/worst.h"

namespace generalized_alpha_test {

using namespace lockstep;

// At w h = 200 all three roots of the method are -rho_infinity nearly: the amplitude goes with n^2 rho^n.
TEST_CASE("rho_infinity is what generalized_alpha leaves of a stiff mode", "[unit][integrators]") {
  struct Case {
    double rho;
    int n;  // late enough for the power, early enough for round-off
  };
  const Case c = GENERATE(Case{0.3, 12}, Case{0.5, 20}, Case{0.8, 40});
  System system;
  Body& mass = system.add_particle("mass", 1, {1e-6, 0, 0});
  Marker &hook = system.add_marker("hook", mass),
         &anchor = system.add_marker("anchor", system.ground(), {{-1, 0, 0}, {}});
  system.add<SpringDamper>("spring", hook, anchor, {.stiffness = 4e6, .free_length = 1});
  system.setup();
  Dynamics dynamics = dynamics_of(system);
  GeneralizedAlpha method(c.rho);
  State s = system.start();
  method.begin(dynamics, s);
  double before = 0;
  for (int i = 0; i < c.n; ++i) {
    before = s.q[0];
    method.step(dynamics, s, 0.1);
  }
  const double power = double(c.n) * c.n / ((c.n - 1.0) * (c.n - 1.0));
  CAPTURE(c.rho, before, s.q[0]);
  CHECK(-s.q[0] / before == Approx(power * c.rho).epsilon(0.03));
}

TEST_CASE("generalized_alpha keeps order 2 when the length of its steps changes", "[unit][integrators]") {
  const auto error_with = [](int n) {
    RodPendulum pendulum;
    Dynamics dynamics = dynamics_of(pendulum.system);
    GeneralizedAlpha method(0.5);
    State s = pendulum.system.start();
    method.begin(dynamics, s);
    double worst = 0;
    for (int i = 0; i < n; ++i) {
      method.step(dynamics, s, (i % 2 == 0 ? 1.5 : 0.5) / n);
      keep_worst(worst, pendulum.error(s));
    }
    return worst;
  };
  CHECK(std::log2(error_with(100) / error_with(200)) == Approx(2).margin(0.15));
}

TEST_CASE("generalized_alpha holds positions and velocities on the constraints", "[unit][integrators]") {
  RodPendulum pendulum;
  DynamicsOptions options;
  options.stabilization.kind = Stabilization::Kind::none;
  Dynamics dynamics = dynamics_of(pendulum.system, options);
  GeneralizedAlpha method;
  State s = pendulum.system.start();
  method.begin(dynamics, s);
  for (int i = 0; i < 100; ++i) {
    const StepReport report = method.step(dynamics, s, 0.02);
    CHECK(report.violation < 1e-10);
    CHECK(dynamics.violation_v(s) < 1e-8);
  }
}

// The multiplier of the end of the step against the pin force of a pendulum let go: m (g cos + w^2 l/2) at the angle.
TEST_CASE("multipliers of generalized_alpha converge with order 2 from the first step", "[unit][integrators]") {
  const auto error_with = [](int n) {
    RodPendulum pendulum;
    Dynamics dynamics = dynamics_of(pendulum.system);
    GeneralizedAlpha method;
    State s = pendulum.system.start();
    method.begin(dynamics, s);
    double worst = 0;
    for (int i = 0; i < n; ++i) {
      method.step(dynamics, s, 0.5 / n);
      const VecX own = method.lambda();
      const VecX exact = dynamics.evaluate(s).lambda;  // of the equations of motion, at a state right to order 2
      keep_worst(worst, (own - exact).lpNorm<Eigen::Infinity>());
    }
    return worst;
  };
  CHECK(std::log2(error_with(50) / error_with(100)) == Approx(2).margin(0.3));
}

TEST_CASE("dense output of generalized_alpha is as good as its steps", "[unit][integrators]") {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  GeneralizedAlpha method;
  State s = top.system.start(), inside = s;
  method.begin(dynamics, s);
  method.step(dynamics, s, 0.1);
  REQUIRE(method.dense(0.05, inside));
  CHECK(top.error(inside) < 2 * top.error(s));
}

TEST_CASE("a step of generalized_alpha that Newton cannot make is an error that names the time",
          "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  GeneralizedAlpha method;
  State s = pendulum.system.start();
  method.begin(dynamics, s);
  method.step(dynamics, s, 0.01);
  const State before = s;
  try {
    method.step(dynamics, s, 50.0);
    FAIL("no error came");
  } catch (const StepError& e) {
    CHECK(e.t == before.t);
    CHECK(std::string(e.what()).find("--step") != std::string::npos);
    CHECK(s.q == before.q);
    CHECK(s.t == before.t);
  }
}

TEST_CASE("the error of an adaptive generalized_alpha follows the tolerance", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  const auto error_at = [&](double tolerance) {
    GeneralizedAlpha method(0.8, true);
    method.set_tolerance({tolerance, 1e-2 * tolerance});
    State s = pendulum.system.start();
    method.begin(dynamics, s);
    double h = method.first_step(dynamics, s, 1.0), worst = 0;
    REQUIRE(h > 0);
    while (s.t < 2) {
      h = method.step(dynamics, s, std::min(h, 2 - s.t)).h_next;
      keep_worst(worst, pendulum.error(s));
    }
    return worst;
  };
  const double loose = error_at(1e-3), tight = error_at(1e-5), slope = std::log10(loose / tight) / 2;
  CAPTURE(loose, tight, slope);
  CHECK(slope == Approx(1).margin(0.25));
  CHECK(loose < 20e-3);
}

}  // namespace generalized_alpha_test
