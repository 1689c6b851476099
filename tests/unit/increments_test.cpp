// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include "tests/support/catch.h"

namespace increments_test {

using namespace lockstep;

namespace {

State one_body(const Quat& e, const Vec3& w) {
  State s;
  s.q = VecX::Zero(7), s.v = VecX::Zero(6), s.s = VecX::Zero(1);
  s.q.segment<4>(3) = e.coefficients();
  s.v.segment<3>(3) = w;
  return s;
}

}  // namespace

// A turn at a constant speed w: e(t) = e0 exp(w t/2) after a first turn D0, so that D(t) = log(exp(D0) exp(w t)) and
// its rate is known by a difference of exact values.
TEST_CASE("the rotation vector of a step changes as in the closed form", "[unit][integrators]") {
  const double size = GENERATE(1e-6, 1e-3, 0.0999, 0.1001, 1.0, 2.4);
  const Vec3 D0 = size * Vec3(0.48, -0.6, 0.64), w(1.3, 0.7, -0.4);
  const auto D = [&](double t) { return rotation_vector(exponential(D0) * exponential(Vec3(t * w))); };
  const double h = 1e-3;  // of order 4
  const Vec3 exact = (8 * (D(h) - D(-h)) - (D(2 * h) - D(-2 * h))) / (12 * h);
  const State start = one_body(exponential(Vec3(0.1, 0.2, 0.3)), w);
  VecX y = VecX::Zero(n_increments(start)), f = y;
  y.segment<3>(3) = D0;
  State here = start;
  displace_state(start, y, here);
  CHECK(here.q.segment<4>(3).norm() == Approx(1).epsilon(1e-14));
  StateRate k{VecX::Zero(7), VecX::LinSpaced(6, 1, 6), VecX::Constant(1, 7)};
  increment_rates(y, here, k, f);
  CAPTURE(size);
  CHECK((f.segment<3>(3) - exact).norm() < 1e-9);
  CHECK((f.segment<6>(6) - k.v).norm() == 0);
  CHECK(f[12] == 7);
}

TEST_CASE("increments counted from another instant lead to the same state", "[unit][integrators]") {
  const State start = one_body(exponential(Vec3(0.4, -0.2, 0.3)), Vec3(1, 2, 3));
  VecX y1 = VecX::LinSpaced(13, -0.5, 0.7), y2 = VecX::LinSpaced(13, 0.9, -0.3);
  State middle = start, end = start, again = start;
  displace_state(start, y1, middle);
  displace_state(start, y2, end);
  VecX y = y2;
  count_from(y1, 6, y);
  displace_state(middle, y, again);
  CHECK((end.q - again.q).norm() < 1e-14);
  CHECK((end.v - again.v).norm() < 1e-14);
  CHECK((end.s - again.s).norm() < 1e-14);
  CHECK(largest_turn(y1, 6) == Approx(y1.segment<3>(3).norm()));
}

TEST_CASE("small increments are differences of states", "[unit][integrators]") {
  const State start = one_body(exponential(Vec3(0.4, -0.2, 0.3)), Vec3(1, 2, 3));
  const VecX y = 1e-5 * VecX::LinSpaced(13, -0.5, 0.7);
  State end = start;
  displace_state(start, y, end);
  StateRate d{VecX::Zero(7), VecX::Zero(6), VecX::Zero(1)};
  as_difference(y, start, d);
  CHECK((end.q - start.q - d.q).norm() < 1e-10);
  CHECK((end.v - start.v - d.v).norm() < 1e-15);
  CHECK((end.s - start.s - d.s).norm() < 1e-15);
}

}  // namespace increments_test
