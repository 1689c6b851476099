// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <algorithm>

#include "tests/support/catch.h"
#include "tests/support/motions.h"
#include "tests/support/worst.h"

namespace dop853_test {

using namespace lockstep;

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
      keep_worst(worst, top.error(inside));
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

}  // namespace dop853_test
