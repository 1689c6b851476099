// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/detail/rows.h>

#include "tests/support/allocations.h"
#include "tests/support/catch.h"

namespace tangent_test {

using namespace lockstep;

namespace {

void write(TangentSum& sum) {
  sum.add_K(2, 0, Mat6::Constant(1.5));
  sum.add_K(2, Half::turn, 0, Half::move, Mat3::Constant(2.0));
  sum.add_D(1, 1, Mat6::Identity());
  sum.add_D(1, Half::move, 1, Half::turn, Mat3::Identity());
  sum.add_K(kGround, 1, Mat6::Ones());
  sum.add_D(0, Half::move, kGround, Half::turn, Mat3::Ones());
}

}  // namespace

TEST_CASE("TangentSum adds by pairs of bodies and ignores the ground", "[unit][kkt]") {
  TangentSum sum;
  sum.lay_out(3);
  write(sum);
  REQUIRE(sum.pairs().size() == 3);  // (2, 0), its mirror image, (1, 1)
  for (std::size_t p = 0; p < 3; ++p) {
    const auto [row, column] = sum.pairs()[p];
    if (row == 0) CHECK((column == 2 && sum.K(p).isZero(0) && sum.D(p).isZero(0)));
    if (row == 1) CHECK((column == 1 && sum.K(p).isZero(0) && sum.D(p)(0, 0) == 1 && sum.D(p)(0, 3) == 1));
    if (row == 2) CHECK((column == 0 && sum.K(p)(0, 0) == 1.5 && sum.K(p)(3, 0) == 3.5 && sum.K(p)(0, 3) == 1.5));
  }
}

TEST_CASE("TangentSum keeps its pattern, and reports its growth", "[unit][kkt]") {
  TangentSum sum;
  sum.lay_out(3);
  write(sum);
  const long revision = sum.revision();
  sum.clear();
  CHECK(sum.pairs().size() == 3);
  CHECK(sum.K(0).isZero(0));
  if (allocations_are_counted())
    CHECK(allocations_of([&] {
            sum.clear();
            write(sum);
          }) == 0);
  CHECK(sum.revision() == revision);
  sum.add_K(0, 1, Mat6::Zero());
  CHECK(sum.revision() > revision);
  CHECK(sum.pairs().size() == 5);
}

TEST_CASE("Differences move one unknown of a body", "[unit][kkt]") {
  Motion O;
  O.e = axis_angle(Vec3(0.3, -0.8, 0.5), 1.1), O.A = rotation(O.e);
  const double h = 1e-3;
  CHECK((Differences::moved(O, 1, h).x - Vec3(0, h, 0)).norm() == 0);
  CHECK((Differences::moved(O, 8, h).v - Vec3(0, 0, h)).norm() == 0);
  CHECK((Differences::moved(O, 9, h).w - Vec3(h, 0, 0)).norm() == 0);
  // a turn in the slot's own axes
  const Motion turned = Differences::moved(O, 5, h);
  CHECK((rotation_vector(conjugate(O.e) * turned.e) - Vec3(0, 0, h)).norm() <= 1e-15);
  CHECK((turned.A - rotation(turned.e)).cwiseAbs().maxCoeff() == 0);

  std::vector<Motion> motions(3);
  Inputs in;
  in.motions = motions;
  const std::vector<int> both{0, 1}, one{0};
  CHECK(Differences::distance(one, in) == 1);  // at the origin
  motions[1].x = Vec3(0, 3, 4);
  CHECK(Differences::distance(one, in) == 5);
  CHECK(Differences::distance(both, in) == 5);
}

}  // namespace tangent_test
