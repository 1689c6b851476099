// SPDX-License-Identifier: BSD-3-Clause
// What rows hold and leave free, for as few unknowns as there can be.
#include <cmath>

#include "framework/dynamics/evaluate/row_space.h"
#include "tests/support/catch.h"

namespace row_space_test {

using namespace lockstep;

TEST_CASE("constraints leave of one unknown all or nothing", "[unit][dynamics]") {
  const VecX u = VecX::Constant(1, 3.0);
  Eigen::SparseMatrix<double> Jt(1, 1);
  Jt.insert(0, 0) = -2.0;
  const RowSpace held(Jt);
  CHECK(held.rank() == 1);
  CHECK(held.free().cols() == 0);
  CHECK(std::abs(held.free_part(u)[0]) < 1e-15);

  Jt.coeffRef(0, 0) = 0.0;
  const RowSpace of_zeros(Jt);
  CHECK(of_zeros.rank() == 0);
  CHECK(of_zeros.free().cols() == 1);
  CHECK(of_zeros.free_part(u)[0] == 3.0);
}

// Two of the rows differ by 1e-4 rad.
TEST_CASE("near dependencies are found also among more constraints than are factored densely", "[unit][dynamics]") {
  Eigen::SparseMatrix<double> Jt(kDenseRows + 1, kDenseRows + 1);
  Jt.setIdentity();
  Jt.coeffRef(0, kDenseRows) = 1, Jt.coeffRef(kDenseRows, kDenseRows) = 1e-4;
  CHECK(Dependencies(Jt).rank == kDenseRows + 1);
  CHECK(Dependencies(Jt, kNearlyDependent).rank == kDenseRows);
}

}  // namespace row_space_test
