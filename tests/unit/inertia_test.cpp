// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/body.h>

#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <lockstep/error.h>
#include "tests/support/messages.h"

namespace inertia_test {

using namespace lockstep;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

struct Point {
  double m;
  Vec3 x;
};

std::vector<Point> cloud(unsigned seed, int n) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> position(-1, 1), mass(0.1, 2);
  std::vector<Point> points;
  for (int i = 0; i < n; ++i) points.push_back({mass(random), {position(random), position(random), position(random)}});
  return points;
}

// The oracle: sums over point masses, J = sum of m (|d|^2 1 - d d') about `origin`.
Mat3 J_about(const std::vector<Point>& points, const Vec3& origin) {
  Mat3 J = Mat3::Zero();
  for (const Point& p : points) {
    const Vec3 d = p.x - origin;
    J += p.m * (d.squaredNorm() * Mat3::Identity() - d * d.transpose());
  }
  return J;
}

MassProperties properties(const std::vector<Point>& points) {
  MassProperties r;
  for (const Point& p : points) r.mass += p.m, r.center += p.m * p.x;
  r.center /= r.mass;
  r.J = J_about(points, r.center);
  return r;
}

void check_equal(const MassProperties& a, const MassProperties& b, double tolerance = 1e-13) {
  CHECK(std::abs(a.mass - b.mass) < tolerance);
  CHECK((a.center - b.center).cwiseAbs().maxCoeff() < tolerance);
  CHECK((a.J - b.J).cwiseAbs().maxCoeff() < tolerance);
}

Quat some_turn() { return normalized(Quat{0.4, -0.3, 0.7, 0.2}); }

// Mass properties of a solid by the midpoint rule on a grid of n^3 cells in the box +-half.
MassProperties integrated(double mass, const Vec3& half, const std::function<bool(const Vec3&)>& inside, int n = 100) {
  std::vector<Point> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const Vec3 u(2 * (i + 0.5) / n - 1, 2 * (j + 0.5) / n - 1, 2 * (k + 0.5) / n - 1);
        const Vec3 x = half.cwiseProduct(u);
        if (inside(x)) points.push_back({1, x});
      }
  for (Point& p : points) p.m = mass / static_cast<double>(points.size());
  return properties(points);
}

void check_shape(const MassProperties& shape, const MassProperties& grid, double relative) {
  CHECK(shape.mass == Approx(grid.mass));
  CHECK(shape.center.norm() == 0);
  CHECK((shape.J - grid.J).cwiseAbs().maxCoeff() < relative * grid.J.cwiseAbs().maxCoeff());
  CHECK_NOTHROW(check_mass(shape, "shape"));
}

std::string problem_of(const MassProperties& p) {
  return message_of<ModelError>([&] { check_mass(p, "body 'crank'"); });
}

MassProperties with_J(double a, double b, double c) { return {1, Vec3::Zero(), Vec3(a, b, c).asDiagonal()}; }

}  // namespace

TEST_CASE("inertia about any point and axes is that of the point masses", "[unit][model]") {
  const std::vector<Point> points = cloud(1, 7);
  const MassProperties truth = properties(points);
  const Vec3 origin(0.3, -0.8, 1.1);
  check_equal(shapes::about(truth.mass, truth.center, J_about(points, origin), origin), truth);

  const Mat3 A = rotation(some_turn());  // the inertia as written in axes turned by A
  check_equal(shapes::about(truth.mass, truth.center, A.transpose() * J_about(points, origin) * A, origin, some_turn()), truth);
}

TEST_CASE("a body seen from another frame is that of the moved point masses", "[unit][model]") {
  std::vector<Point> points = cloud(2, 5);
  const MassProperties before = properties(points);
  const Pose pose{{0.5, 2, -1}, some_turn()};
  for (Point& p : points) p.x = pose.x + rotation(pose.q) * p.x;
  check_equal(shapes::moved(before, pose), properties(points));
  check_equal(shapes::moved(shapes::moved(before, pose), inverse(pose)), before);
}

TEST_CASE("a compound is that of all its point masses", "[unit][model]") {
  const std::vector<Point> a = cloud(3, 4), b = cloud(4, 6);
  std::vector<Point> all = a;
  all.insert(all.end(), b.begin(), b.end());
  const std::vector<MassProperties> parts{properties(a), properties(b)};
  check_equal(shapes::compound(parts), properties(all));
  check_words(message_of<ModelError>([&] { shapes::compound({}); }), {"a compound without parts", "give at least one"});
  check_words(message_of<ModelError>([&] {
                shapes::compound(std::vector<MassProperties>{parts[0], {}});
              }),
              {"compound: the mass of a part is 0"});
}

TEST_CASE("shapes have the inertia of their solids", "[unit][model]") {
  const double r = 0.3;
  const auto always = [](const Vec3&) { return true; };
  check_shape(shapes::box(2, {0.2, 0.5, 0.9}), integrated(2, {0.1, 0.25, 0.45}, always), 2e-4);
  check_shape(shapes::cylinder(3, r, 0.8),
              integrated(3, {r, r, 0.4}, [&](const Vec3& x) { return std::hypot(x[0], x[1]) < r; }), 2e-3);
  check_shape(shapes::sphere(4, r), integrated(4, {r, r, r}, [&](const Vec3& x) { return x.norm() < r; }), 2e-3);
  const Shape solid = shapes::rod(5, {0, 0, 0}, {0.9, 0, 0}, 0.2);
  check_shape(solid.mass, integrated(5, {0.45, 0.2, 0.2}, [](const Vec3& x) { return std::hypot(x[1], x[2]) < 0.2; }),
              2e-3);
}

TEST_CASE("volumes", "[unit][model]") {
  CHECK(box_volume({2, 3, 4}) == Approx(24));
  CHECK(cylinder_volume(2, 3) == Approx(12 * kPi));
  CHECK(sphere_volume(3) == Approx(36 * kPi));
}

TEST_CASE("a rod lies between its ends", "[unit][model]") {
  const Vec3 from(1, 2, 3), to(2, 4, 1);
  const Shape shape = shapes::rod(2, from, to);
  const Mat3 A = rotation(shape.home.q);
  CHECK((shape.home.x - Vec3(1.5, 3, 2)).norm() < 1e-15);
  CHECK((A.col(0) - Vec3(1, 2, -2) / 3).norm() < 1e-15);  // x from `from` to `to`
  CHECK(std::abs(A.col(1)[2]) < 1e-15);                   // z as near to the world's z as can be: y is level
  CHECK(A.col(2)[2] > 0);
  CHECK(shape.mass.J(0, 0) == Approx(0.5 * 2 * 0.06 * 0.06));  // radius: a fiftieth of the length 3
  CHECK_NOTHROW(check_mass(shape.mass, "rod"));
}

TEST_CASE("a rod along the world's z has its z axis along the world's y", "[unit][model]") {
  for (const double way : {1.0, -1.0}) {
    const Mat3 A = rotation(shapes::rod(1, {0, 0, 0}, {0, 0, way}).home.q);
    CHECK((A.col(0) - Vec3(0, 0, way)).norm() < 1e-15);
    CHECK((A.col(2) - Vec3::UnitY()).norm() < 1e-15);
  }
}

TEST_CASE("a slender rod has the axial inertia it is given", "[unit][model]") {
  const Shape shape = shapes::slender_rod(3, {0, 0, 0}, {0, 2, 0}, 1e-6);
  CHECK(shape.mass.J(0, 0) == 1e-6);
  CHECK(shape.mass.J(1, 1) == Approx(1));
  CHECK(shape.mass.J(2, 2) == Approx(1));
  CHECK_NOTHROW(check_mass(shape.mass, "rod"));
  check_words(message_of<ModelError>([] { shapes::slender_rod(3, {0, 0, 0}, {0, 2, 0}, 0); }), {"axial inertia is 0"});
}

TEST_CASE("impossible shapes are rejected", "[unit][model]") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  check_words(message_of<ModelError>([] { shapes::box(1, {1, -2, 1}); }), {"-2", "greater than zero"});
  check_words(message_of<ModelError>([&] { shapes::box(0, {1, 1, 1}); }), {"box: the mass is 0"});
  check_words(message_of<ModelError>([&] { shapes::cylinder(1, 0, 1); }), {"cylinder: the radius is 0"});
  check_words(message_of<ModelError>([&] { shapes::cylinder(1, 1, nan); }), {"cylinder: the length is nan"});
  check_words(message_of<ModelError>([&] { shapes::sphere(infinity, 1); }), {"sphere: the mass is inf"});
  check_words(message_of<ModelError>([&] { shapes::sphere(1, -1); }), {"sphere: the radius is -1"});
  check_words(message_of<ModelError>([] { shapes::rod(1, {1, 1, 1}, {1, 1, 1}); }), {"length is 0"});
  check_words(message_of<ModelError>([&] { shapes::rod(1, {0, 0, 0}, {1, 0, 0}, 0); }), {"rod: the radius is 0"});
}

TEST_CASE("the triangle rule holds with equality", "[unit][model]") {
  CHECK(problem_of(with_J(1, 2, 3)) == "no error");            // a plate
  CHECK(problem_of(with_J(1e-6, 1, 1 + 1e-6)) == "no error");  // a thin one
  CHECK(problem_of(shapes::moved(with_J(1, 2, 3), {Vec3::Zero(), some_turn()})) == "no error");
  const std::string problem = problem_of(with_J(1, 2, 3.001));
  check_words(problem, {"body 'crank': ", "triangle inequality", "1, 2, 3.001 kg m^2", "matrix entries"});
  check_words(problem_of(with_J(1, 1, 2.0000001)), {"triangle inequality", "1, 1, 2.0000001 kg m^2"});
  check_words(problem_of(with_J(1, 1, 5)), {"triangle inequality", "(principal moments 1, 1, 5 kg m^2)"});
  CHECK(problem_of(with_J(1, 2, 3 * (1 + 1e-9))) != "no error");
}

TEST_CASE("impossible mass properties are rejected with name and value", "[unit][model]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MassProperties p = with_J(1, 1, 1);
  p.mass = -2;
  check_words(problem_of(p), {"body 'crank'", "mass is -2", "greater than zero"});
  p.mass = 0;
  check_words(problem_of(p), {"mass is 0"});
  p.mass = nan;
  check_words(problem_of(p), {"mass is nan"});
  p = with_J(1, 1, 1);
  p.center[1] = nan;
  check_words(problem_of(p), {"centre of mass is not finite"});
  check_words(problem_of(with_J(1, nan, 1)), {"inertia is not finite"});
  check_words(problem_of(with_J(0, 1, 1)), {"not positive definite", "0, 1, 1", "particle"});
  check_words(problem_of(with_J(-1, 1, 1)), {"not positive definite"});
  p = with_J(1, 1, 1);
  p.J(0, 1) = 0.1;
  check_words(problem_of(p), {"not symmetric", "0.1", "J_xy = J_yx"});
}

}  // namespace inertia_test
