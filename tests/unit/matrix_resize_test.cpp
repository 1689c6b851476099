// SPDX-License-Identifier: BSD-3-Clause
// Matrices whose new size finds no memory.
#include <new>

#include <lockstep/math.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"

namespace matrix_resize_test {

using namespace lockstep;

TEST_CASE("a matrix whose new size finds no memory is empty, and is freed once", "[unit][math]") {
  if (!allocations_are_counted()) return;                // a sanitizer ends a program that asks for so much
  volatile Eigen::Index beyond = Eigen::Index{1} << 46;  // numbers: more than there are addresses
  const VecX three = VecX::Ones(3);
  VecX resized = three, zero = three, assigned = three;
  MatX matrix = MatX::Ones(2, 3);
  CHECK_THROWS_AS(resized.resize(beyond), std::bad_alloc);
  CHECK_THROWS_AS(zero.setZero(beyond), std::bad_alloc);
  CHECK_THROWS_AS(assigned = VecX::Constant(beyond, 1.0), std::bad_alloc);
  CHECK_THROWS_AS(matrix.resize(beyond, 2), std::bad_alloc);
  for (const VecX* x : {&resized, &zero, &assigned}) CHECK(x->size() == 0);
  CHECK(matrix.size() == 0);
  resized = three;  // and goes on
  CHECK(resized == three);
}

TEST_CASE("a matrix keeps its memory where its size stays, and its fixed size", "[unit][math]") {
  VecX x = VecX::LinSpaced(6, 1, 6);
  const double* const at = x.data();
  x.resize(6);
  CHECK(x.data() == at);
  CHECK(x[5] == 6);
  Eigen::Matrix<double, 3, Eigen::Dynamic> columns(3, 2);
  columns.setZero(Eigen::NoChange, 5);
  CHECK(columns.cols() == 5);
  CHECK(columns.norm() == 0);
  Mat3 fixed = Mat3::Ones();
  fixed.resize(3, 3);
  CHECK(fixed.sum() == 9);
}

}  // namespace matrix_resize_test
