// SPDX-License-Identifier: BSD-3-Clause
// The identities of the theory's section 1, on random quaternions, against the oracle's product matrices.
#include <cmath>

#include <lockstep/math.h>
#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/paper_lock.h"

namespace quaternion_test {

using namespace lockstep;
using oracle::Draw;
namespace paper = oracle::paper;

namespace {
constexpr double kTolerance = 1e-14;
double apart(const MatX& a, const MatX& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}
Quat quat(const Vec4& c) { return Quat::from(c); }
}  // namespace

TEST_CASE("products, conjugates and lengths of quaternions", "[unit][math]") {
  Draw draw(1);
  for (int n = 0; n < 20; ++n) {
    const Vec4 a = 2.0 * draw.quaternion(), b = 0.7 * draw.quaternion();
    const Vec4 ab = (quat(a) * quat(b)).coefficients();
    CHECK(apart(ab, paper::plus(a) * b) < kTolerance);  // (1.3)
    CHECK(apart(ab, paper::minus(b) * a) < kTolerance);
    CHECK(apart(conjugate(quat(a) * quat(b)).coefficients(), (conjugate(quat(b)) * conjugate(quat(a))).coefficients()) <
          kTolerance);
    CHECK(std::abs(norm2(quat(a)) - a.squaredNorm()) < kTolerance);
    CHECK(apart((conjugate(quat(a)) * quat(a)).coefficients(), norm2(quat(a)) * Vec4::UnitX()) < kTolerance);
    CHECK(apart(normalized(quat(a)).coefficients(), a.normalized()) < kTolerance);
    CHECK(apart((-quat(a)).coefficients(), -a) == 0);
    CHECK(apart((quat(a) + quat(b)).coefficients(), a + b) == 0);
    CHECK(quat(a).vec() == a.tail<3>());
    CHECK(Quat::from(a[0], Vec3(a.tail<3>())).coefficients() == a);
  }
}

TEST_CASE("the rotation matrix of a quaternion and back", "[unit][math]") {
  Draw draw(2);
  for (int n = 0; n < 40; ++n) {
    Vec4 a = draw.quaternion();
    if (n < 4) a = Vec4::Unit(n);  // no turn, and half turns about each axis
    if (n >= 4 && n < 8) a = (Vec4::Unit(n - 4) + 1e-9 * a).normalized();
    const Vec4 b = draw.quaternion();
    const Mat3 A = rotation(quat(a));
    CAPTURE(n);
    CHECK(apart(A, paper::rotation(a)) < kTolerance);  // (1.5)
    CHECK(apart(A * A.transpose(), Mat3::Identity()) < kTolerance);
    CHECK(std::abs(A.col(0).dot(cross(A.col(1), A.col(2))) - 1) < kTolerance);
    const Vec3 v = draw.vector(1.0);
    CHECK(apart(A * v, oracle::quaternion_turned(a, v)) < kTolerance);
    CHECK(apart(rotation(quat(a) * quat(b)), A * rotation(quat(b))) < kTolerance);
    CHECK(apart(rotation(conjugate(quat(a))), A.transpose()) < kTolerance);
    CHECK(rotation(-quat(a)) == A);
    const Vec4 back = quaternion_of(A).coefficients();
    CHECK(std::min((back - a).norm(), (back + a).norm()) < 1e-14);
  }
}

TEST_CASE("angular velocity and the rates of a quaternion", "[unit][math]") {
  Draw draw(3);
  for (int n = 0; n < 20; ++n) {
    const Vec4 q = draw.quaternion();
    const Vec3 w = draw.vector(2.0), al = draw.vector(3.0);
    const Mat34 G = G_matrix(quat(q));
    CHECK(apart(G, paper::G(q)) < kTolerance);                           // (1.6)
    CHECK(apart(G * G.transpose(), 4 * Mat3::Identity()) < kTolerance);  // (1.7)
    CHECK(apart(G.transpose() * G, 4 * (Eigen::Matrix4d::Identity() - q * q.transpose())) < kTolerance);
    CHECK((G * q).norm() < kTolerance);
    const Vec4 qd = rate(quat(q), w).coefficients();  // (1.8)
    CHECK(apart(qd, 0.25 * G.transpose() * w) < kTolerance);
    CHECK(apart(G * qd, w) < kTolerance);
    CHECK(std::abs(q.dot(qd)) < kTolerance);  // (1.13)
    CHECK(std::abs(qd.squaredNorm() - 0.25 * w.squaredNorm()) < kTolerance);
    const Mat34 Gd = G_matrix(quat(qd));
    CHECK(apart(G * Gd.transpose(), 2 * skew(w)) < kTolerance);
    CHECK((Gd * qd).norm() < kTolerance);
    CHECK(apart(Gd * q, -w) < kTolerance);
    const Vec4 qdd = second_rate(quat(q), w, al).coefficients();  // (1.9)
    CHECK(apart(qdd, 0.25 * G.transpose() * al - 0.25 * w.squaredNorm() * q) < kTolerance);
    CHECK(apart(G * qdd, al) < kTolerance);
    CHECK(std::abs(q.dot(qdd) + qd.squaredNorm()) < kTolerance);
    CHECK(apart(skew(w) * al, cross(w, al)) < kTolerance);
    CHECK(apart(skew(w) * al, paper::skew(w) * al) < kTolerance);
  }
}

TEST_CASE("rotations of a vector: exponential, Cayley and the rotation vector", "[unit][math]") {
  Draw draw(4);
  for (double angle : {0.0, 1e-12, 1e-9, 1e-5, 9.9e-3, 1.01e-2, 0.3, 1.0, 3.0, 3.14159}) {
    for (int k = 0; k < 5; ++k) {
      const Vec3 n = draw.vector(1.0).normalized(), th = angle * n;
      CAPTURE(angle);
      Vec4 exact;  // (1.12)
      exact << std::cos(angle / 2), std::sin(angle / 2) * n;
      CHECK(apart(exponential(th).coefficients(), exact) < 2e-16 * 4);
      CHECK(std::abs(norm2(exponential(th)) - 1) < kTolerance);
      CHECK(apart(axis_angle(Vec3(3.0 * n), angle).coefficients(), exact) < kTolerance);
      // relative: a small turn comes back with all its digits
      const Vec3 back = rotation_vector(exponential(th));
      CHECK((back - th).norm() <= 1e-14 * std::max(angle, 1e-300));
      CHECK((rotation_vector(-exponential(th)) - th).norm() <= 1e-14 * std::max(angle, 1e-300));
      const Quat c = cayley(th);
      CHECK(std::abs(norm2(c) - 1) < kTolerance);
      CHECK(std::abs(2 * std::atan2(c.vec().norm(), c.w) - 2 * std::atan(angle / 2)) < kTolerance);
    }
  }
  // beyond half a turn the rotation vector takes the short way
  CHECK((rotation_vector(axis_angle(Vec3::UnitY(), 4.0)) - (4.0 - kTwoPi) * Vec3::UnitY()).norm() < kTolerance);
  // exp(th) exp(-th) = 1, and turns about one axis add
  const Vec3 th(0.3, -0.2, 0.9);
  CHECK(apart((exponential(th) * exponential(Vec3(-th))).coefficients(), Vec4::UnitX()) < kTolerance);
  CHECK(apart((exponential(th) * exponential(Vec3(2 * th))).coefficients(), exponential(Vec3(3 * th)).coefficients()) <
        kTolerance);
}

TEST_CASE("half rotations of a vector normal to the axis", "[unit][math]") {
  // (1.11) q0 v + qv x v turns v by half the angle
  const Vec3 n = Vec3(1, 2, -2) / 3.0, v = Vec3(2, 0, 1).normalized();
  REQUIRE(std::abs(n.dot(v)) < kTolerance);
  const Quat q = axis_angle(n, 1.3);
  CHECK(apart(q.w * v + cross(q.vec(), v), rotation(axis_angle(n, 0.65)) * v) < kTolerance);
  CHECK(apart(q.w * v - cross(q.vec(), v), rotation(axis_angle(n, -0.65)) * v) < kTolerance);
}

}  // namespace quaternion_test
