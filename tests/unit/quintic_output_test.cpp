// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/motions.h"

namespace quintic_output_test {

using namespace lockstep;

namespace {

/// Exact state of a thrown body of revolution, its accelerations by Euler's equations.
struct Exact {
  State y;
  VecX vd, sd;
};
Exact at(const ThrownTop& top, double t) {
  Exact e;
  e.y = top.system.start();
  e.y.t = t;
  const Pose p = top.pose(t);
  e.y.q << p.x, p.q.coefficients();
  const Quat turned = conjugate(p.q) * top.q0;  // L is constant in the world
  const Vec3 J(ThrownTop::kJ1, ThrownTop::kJ1, ThrownTop::kJ3);
  const Vec3 w = (rotation(turned) * Vec3(J.cwiseProduct(top.start.w))).cwiseQuotient(J);
  e.y.v << top.v0 + t * top.g, w;
  e.vd.resize(6);
  e.vd << top.g, -Vec3(cross(w, Vec3(J.cwiseProduct(w)))).cwiseQuotient(J);
  e.sd.resize(0);
  return e;
}

}  // namespace

TEST_CASE("the quintic has local order 6 in positions and 5 in velocities", "[unit][integrators]") {
  const ThrownTop top;
  double error[2], error_v[2];
  for (int i = 0; i < 2; ++i) {
    const double h = 0.1 / (1 << i);
    const Exact a = at(top, 0.3), b = at(top, 0.3 + h), middle = at(top, 0.3 + 0.4 * h);
    QuinticOutput output;
    output.begin(a.y);
    output.set(a.y, a.vd, a.sd, b.y, b.vd, b.sd);
    State inside;
    REQUIRE(output.at(0.3 + 0.4 * h, inside));
    error[i] = top.error(inside), error_v[i] = (inside.v - middle.y.v).norm();
    CHECK(inside.q.segment<4>(3).norm() == Approx(1).epsilon(1e-14));
  }
  CHECK(std::log2(error[0] / error[1]) == Approx(6).margin(0.2));
  CHECK(std::log2(error_v[0] / error_v[1]) == Approx(5).margin(0.2));
}

TEST_CASE("the quintic without a step is defined only at its start", "[unit][integrators]") {
  const ThrownTop top;
  QuinticOutput output;
  State out;
  CHECK_FALSE(output.at(0, out));
  output.begin(at(top, 0.3).y);
  CHECK(output.at(0.3, out));
  CHECK(out.q == at(top, 0.3).y.q);
  CHECK_FALSE(output.at(0.4, out));
}

}  // namespace quintic_output_test
