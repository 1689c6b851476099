// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/solver.h>

#include "tests/support/catch.h"
#include "tests/support/dense.h"
#include "tests/support/random_kkt.h"

namespace kkt_test {

using namespace lockstep;
using namespace lockstep::test;

TEST_CASE("scales: the mean over a joint's translational constraints, over its rotational ones, each function its own",
          "[unit][kkt]") {
  KktBuilder b(1);
  b.slot(), b.slot(3), b.slot(7);
  b.link({0}, rows_of(3, 2));
  b.link({1, 0}, rows_of(2, 0, 2));
  b.link({2, 0, 1}, rows_of(1, 3, 1));
  b.unit_length_row(2);
  const KktSystem system = b.finish();
  const VecX S = (system.J() * dense::inverse(system.M()) * system.J().transpose()).diagonal();
  VecX expected = S;
  expected.segment(0, 3).setConstant(S.segment(0, 3).mean());
  expected.segment(3, 2).setConstant(S.segment(3, 2).mean());
  expected.segment(5, 2).setConstant(S.segment(5, 2).mean());
  expected.segment(10, 3).setConstant(S.segment(10, 3).mean());
  CHECK(difference(system.kkt.E, expected) <= 1e-13);
}

TEST_CASE("scales do not know the axes of a triple", "[unit][kkt]") {
  const KktSystem plain = random_system(0, 2, false);
  KktBuilder b(3);
  const MatX Q = dense::orthogonal(b.numbers(3, 3));
  KktSystem turned = plain;
  MatX J = plain.J();
  J.middleRows(5, 3) = Q * J.middleRows(5, 3);
  turned.write_J(J);
  turned.kkt.update_scales();
  CHECK(difference(turned.kkt.E, plain.kkt.E) <= 1e-13);
}

TEST_CASE("a joint without bodies, and one whose gradients vanish, still have a positive scale", "[unit][kkt]") {
  KktBuilder b(4);
  b.slot();
  b.link({}, rows_of(1, 0, 1));
  b.link({0}, rows_of(0, 0, 1));
  KktSystem system = b.finish();
  std::fill(system.kkt.J.begin(), system.kkt.J.end(), 0.0);
  system.kkt.update_scales();
  CHECK(system.kkt.E.minCoeff() > 0.0);
}

}  // namespace kkt_test
