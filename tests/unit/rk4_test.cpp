#include "integrators/rk4.h"

#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/motions.h"

using namespace lockstep;

TEST_CASE("rk4 converges with order 4", "[unit][integrators]") {
  Rk4 method;
  ThrownTop top;
  CHECK(measured_order(top, method, 1.0, 50) == Approx(4).margin(0.15));
  RodPendulum pendulum;
  CHECK(measured_order(pendulum, method, 1.0, 50) == Approx(4).margin(0.15));
}

TEST_CASE("rk4 lands on the constraints and keeps unit quaternions", "[unit][integrators]") {
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Rk4 method;
  const State s = stepped(dynamics, method, 1.0, 40);
  CHECK(dynamics.violation(s) < 1e-10);
  CHECK(dynamics.violation_v(s) < 1e-10);
  CHECK(s.q.segment<4>(3).norm() == Approx(1).epsilon(1e-15));
}

TEST_CASE("a step of rk4 allocates nothing", "[unit][integrators]") {
  if (!allocations_are_counted()) return;
  RodPendulum pendulum;
  Dynamics dynamics = dynamics_of(pendulum.system);
  Rk4 method;
  State s = pendulum.system.start();
  method.begin(dynamics, s);
  for (int i = 0; i < 3; ++i) method.step(dynamics, s, 0.01);
  CHECK(allocations_of([&] {
          for (int i = 0; i < 20; ++i) method.step(dynamics, s, 0.0123456789);
        }) == 0);
  CHECK(allocations_of([&] { Rk4().begin(dynamics, s); }) > 0);  // the library's are counted
}
