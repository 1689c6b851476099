// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/stepping.h>

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace step_control_test {

using namespace lockstep;

TEST_CASE("the controller's factors stay within 0.2 and 5", "[unit][integrators]") {
  PiControl control(5);
  CHECK(control.accept(0.1, 0, 0, false) == 5.0);
  CHECK(control.accept(0.1, 1e-12, 0, true) == 1.0);
  CHECK(control.reject(1e30) == 0.2);
  CHECK(control.reject(HUGE_VAL) == 0.2);
  CHECK(control.reject(1.01) < 1);
}

TEST_CASE("the controller follows 0.9 err^(-0.7/p) before^(0.4/p)", "[unit][integrators]") {
  PiControl control(8);
  control.accept(0.1, 0.5, 0, false);
  CHECK(control.accept(0.1, 0.25, 0, false) == Approx(0.9 * std::pow(0.25, -0.7 / 8) * std::pow(0.5, 0.4 / 8)));
  control.begin();
  CHECK(control.accept(0.1, 0.25, 0, false) == Approx(0.9 * std::pow(0.25, -0.7 / 8) * std::pow(1e-4, 0.4 / 8)));
}

TEST_CASE("errors are weighed in metres, radians and their rates", "[unit][integrators]") {
  ThrownTop top;
  const State y0 = top.system.start();
  State y1 = y0;
  StateRate k = sized_like(y0), error = sized_like(y0);
  const double h = 0.5, rtol = 1e-3, atol = 1e-6;
  ErrorNorm norm;
  norm.set({rtol, atol});
  y1.q[0] += 10;  // more than h |v|
  norm.scale(y0, k, h, y1);
  error.q[1] = 1e-3;
  CHECK(norm.of(error, y1) == Approx(1e-3 / (atol + rtol * 10)));
  error.q.setZero();
  const Quat turned = y1.slot_pose(0).q * exponential(Vec3(0, 1e-4, 0));
  error.q.segment<4>(3) = turned.coefficients() - y1.q.segment<4>(3);
  CHECK(norm.of(error, y1) == Approx(1e-4 / (atol + rtol * h * top.start.w.norm())).epsilon(1e-6));
  error.q.segment<4>(3) = 1e-3 * y1.q.segment<4>(3);  // only the length: normalised away
  CHECK(norm.of(error, y1) < 1e-9);
  error.q.setZero();
  error.v[2] = 1e-6;  // velocities did not change: atol alone
  CHECK(norm.of(error, y1) == Approx(1));
  error.v[2] = NAN;
  CHECK(norm.of(error, y1) == HUGE_VAL);
}

}  // namespace step_control_test
