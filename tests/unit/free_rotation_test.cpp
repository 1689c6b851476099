// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <cmath>

#include "tests/support/catch.h"

namespace free_rotation_test {

using namespace lockstep;

namespace {

Mat3 turned_inertia() {
  const Mat3 A = rotation(exponential(Vec3(0.4, -0.9, 0.3)));
  const Mat3 J = A * Vec3(0.4, 0.6, 0.9).asDiagonal() * A.transpose();
  return 0.5 * (J + J.transpose());
}

}  // namespace

TEST_CASE("a free body conserves its angular momentum in space, for every step size", "[unit][integrators]") {
  const Mat3 J = turned_inertia();
  const FreeRotation rotation_split(J);
  Quat e = exponential(Vec3(1, 2, -0.5));
  Vec3 w(1.5, -2, 0.7);
  const Vec3 L = rotation(e) * (J * w);
  for (const double t : {0.3, -0.05, 2.0, 0.01}) {
    rotation_split.turn(t, e, w);
    CHECK((rotation(e) * (J * w) - L).norm() < 1e-14 * L.norm());
  }
}

TEST_CASE("a free body rotated forward and back returns to its pose", "[unit][integrators]") {
  const FreeRotation split(turned_inertia());
  const Quat e0 = exponential(Vec3(1, 2, -0.5));
  const Vec3 w0(1.5, -2, 0.7);
  Quat e = e0;
  Vec3 w = w0;
  split.turn(0.4, e, w);
  REQUIRE((w - w0).norm() > 0.1);
  split.turn(-0.4, e, w);
  CHECK((w - w0).norm() < 1e-14);
  CHECK((e.coefficients() - e0.coefficients()).norm() < 1e-14);
}

// Closed form for a body of revolution: q = exp(t L/J1) q0 exp((1 - J3/J1) w3 t e3).
TEST_CASE("the split rotation of a top is of order 2", "[unit][integrators]") {
  const double J1 = 0.4, J3 = 0.7, T = 1;
  const FreeRotation split(Vec3(J1, J1, J3).asDiagonal());
  const Vec3 w0(1.1, 0.4, 2.5), L(J1 * w0[0], J1 * w0[1], J3 * w0[2]);
  const Quat exact = exponential(Vec3(T / J1 * L)) * exponential(Vec3(0, 0, T * (1 - J3 / J1) * w0[2]));
  double error[2];
  for (const int k : {0, 1}) {
    const int n = k == 0 ? 20 : 40;
    Quat e;
    Vec3 w = w0;
    for (int i = 0; i < n; ++i) split.turn(T / n, e, w);
    error[k] = rotation_vector(conjugate(exact) * e).norm();
  }
  CHECK(std::log2(error[0] / error[1]) == Approx(2).margin(0.05));
}

}  // namespace free_rotation_test
