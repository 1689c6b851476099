// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <cmath>

#include "tests/support/catch.h"

namespace predictive_control_test {

using namespace lockstep;

TEST_CASE("the controller of implicit methods follows the fourth root within its bounds", "[unit][integrators]") {
  PredictiveControl control;
  control.begin();
  const double factor = control.accept(0.1, 1.0 / 16, 1, false);
  CHECK(factor == Approx(2 * 0.9 * 21.0 / 21).epsilon(0.05));
  control.begin();
  CHECK(control.accept(0.1, 0.0, 1, false) == 5);
  control.begin();
  CHECK(control.accept(0.1, 1e-4, 1, true) == 1);  // no growth after a rejection
  CHECK(control.reject(16, 1) == Approx(0.9 / 2).epsilon(0.05));
  CHECK(control.reject(HUGE_VAL, 1) == 0.2);
  control.begin();
  const double many = control.accept(0.1, 1.0 / 16, 10, false);
  CHECK(many < factor);  // more iterations, more careful
}

// An error that grows from step to step by the same factor is taken to grow on.
TEST_CASE("the controller of implicit methods sees an error coming", "[unit][integrators]") {
  PredictiveControl rising, steady;
  rising.accept(0.1, 0.1, 3, false);
  steady.accept(0.1, 0.5, 3, false);
  CHECK(rising.accept(0.1, 0.5, 3, false) < steady.accept(0.1, 0.5, 3, false));
}

TEST_CASE("the controller of implicit methods can be put back", "[unit][integrators]") {
  PredictiveControl a, b;
  a.accept(0.1, 0.3, 3, false);
  Snapshot memory;
  a.save(memory);
  SnapshotReader in(memory);
  b.restore(in);
  CHECK(a.accept(0.12, 0.5, 3, false) == b.accept(0.12, 0.5, 3, false));
}

}  // namespace predictive_control_test
