#include "integrators/dop853.h"

#include <algorithm>

#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/motions.h"

using namespace lockstep;

TEST_CASE("dop853 with a fixed step converges with order 8", "[unit][integrators]") {
  Dop853 method(true);
  ThrownTop top;
  CHECK(measured_order(top, method, 2.0, 14) == Approx(8).margin(0.4));
  RodPendulum pendulum;
  CHECK(measured_order(pendulum, method, 2.0, 14) == Approx(8).margin(0.5));
}

TEST_CASE("dense output of dop853 has local order 8", "[unit][integrators]") {
  Dop853 method(true);
  ThrownTop top;
  CHECK(measured_dense_order(top, method, 0.2) == Approx(8).margin(0.5));
}

TEST_CASE("dense output of dop853 is as good as its steps", "[unit][integrators]") {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  Dop853 method;
  method.set_tolerance({1e-9, 1e-11});
  State s = top.system.start(), inside = s;
  method.begin(dynamics, s);
  double h = method.first_step(dynamics, s, 1.0), worst = 0;
  while (s.t < 2) {
    const double t = s.t;
    h = method.step(dynamics, s, std::min(h, 2 - t)).h_next;
    for (const double theta : {0.1, 0.35, 0.6, 0.85}) {
      REQUIRE(method.dense(t + theta * (s.t - t), inside));
      worst = std::max(worst, top.error(inside));
    }
  }
  CHECK(top.error(s) < 2e-8);
  CHECK(worst < 2e-8);
}

TEST_CASE("dop853 evaluates the stages of its dense output only when asked", "[unit][integrators]") {
  ThrownTop top;
  Dynamics dynamics = dynamics_of(top.system);
  Dop853 method(true);
  State s = top.system.start(), inside = s;
  method.begin(dynamics, s);
  method.step(dynamics, s, 0.1);
  CHECK(dynamics.work().evaluations == 12);
  method.dense(0.03, inside);
  method.dense(0.07, inside);
  CHECK(dynamics.work().evaluations == 16);
}

TEST_CASE("rejected steps of dop853 leave no trace", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Dop853 eager, calm;
  State a = pendulum.system.start(), b = a;
  eager.begin(dynamics, a);
  const StepReport tried = eager.step(dynamics, a, 5.0);
  REQUIRE(tried.rejected > 0);
  calm.begin(dynamics, b);
  REQUIRE(calm.step(dynamics, b, tried.h).rejected == 0);
  CHECK(a.q == b.q);
  CHECK(a.v == b.v);
  CHECK(eager.step(dynamics, a, 0.01).h_next == calm.step(dynamics, b, 0.01).h_next);
  CHECK(a.q == b.q);
}

TEST_CASE("a step of dop853 allocates nothing, nor does its dense output", "[unit][integrators]") {
  if (!allocations_are_counted()) return;
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Dop853 method;
  State s = pendulum.system.start(), inside = s;
  method.begin(dynamics, s);
  const auto run = [&] {
    for (int i = 0; i < 5; ++i) {
      const double t = s.t;
      method.step(dynamics, s, 0.0123456789);
      method.dense(0.5 * (t + s.t), inside);
    }
  };
  run();
  CHECK(allocations_of(run) == 0);
}
