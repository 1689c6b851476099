// SPDX-License-Identifier: BSD-3-Clause
// Poses: composition and inverse, against points carried one by one.
#include <lockstep/math.h>

#include "tests/support/catch.h"
#include "tests/support/configuration.h"

namespace pose_test {

using namespace lockstep;

namespace {
Vec3 carried(const Pose& a, const Vec3& p) { return a.x + oracle::quaternion_turned(a.q.coefficients(), p); }
Pose random_pose(oracle::Draw& draw) { return {draw.vector(2.0), Quat::from(draw.quaternion())}; }
}  // namespace

TEST_CASE("poses compose, and an inverse takes back", "[unit][math]") {
  oracle::Draw draw(5);
  for (int n = 0; n < 20; ++n) {
    const Pose a = random_pose(draw), b = random_pose(draw), c = random_pose(draw);
    const Vec3 p = draw.vector(1.0);
    CHECK((carried(a * b, p) - carried(a, carried(b, p))).norm() < 1e-14);
    CHECK((carried(inverse(a), carried(a, p)) - p).norm() < 1e-14);
    CHECK((carried((a * b) * c, p) - carried(a * (b * c), p)).norm() < 1e-14);
    const Pose one = inverse(a) * a;
    CHECK(one.x.norm() < 1e-14);
    CHECK((one.q.coefficients() - Vec4::UnitX()).norm() < 1e-14);
    // the sign of the quaternion is kept: q' q_1, never minus it
    CHECK(((a * b).q.coefficients() - oracle::quaternion_product(a.q.coefficients(), b.q.coefficients())).norm() <
          1e-15);
  }
}

TEST_CASE("a pose by itself is the frame of its parent", "[unit][math]") {
  const Pose none;
  CHECK(none.x == Vec3::Zero());
  CHECK(none.q.coefficients() == Vec4::UnitX());
  const Twist still;
  CHECK(still.v == Vec3::Zero());
  CHECK(still.w == Vec3::Zero());
}

}  // namespace pose_test
