// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace semi_implicit_euler_test {

using namespace lockstep;

TEST_CASE("semi-implicit Euler takes the new velocity to move", "[unit][integrators]") {
  System system(System::Options{{0, 0, -10}});
  system.add_particle("stone", 3, {0, 0, 1});
  Dynamics dynamics = dynamics_of(system);
  SemiImplicitEuler method;
  State s = system.start();
  method.begin(dynamics, s);
  const StepReport report = method.step(dynamics, s, 0.1);
  CHECK(report.h == 0.1);
  CHECK(report.h_next == 0);
  CHECK(s.v[2] == Approx(-1).epsilon(1e-14));
  CHECK(s.q[2] == Approx(0.9).epsilon(1e-14));
  CHECK_FALSE(method.dense(0.05, s));
}

}  // namespace semi_implicit_euler_test
