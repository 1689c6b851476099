// SPDX-License-Identifier: BSD-3-Clause
// The references whose joints are functions: spatial slider-crank, linkage of Peaucellier, Stewart platform.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/joints.h>
#include <lockstep/kinematics.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace references_of_joints_test {

using namespace lockstep;

namespace {

void check_columns(const Table& ours, const Table& truth, std::vector<std::string> unrecorded,
                   const std::function<double(const ColumnError&)>& limit) {
  const auto errors = compare(ours, truth);
  CHECK(errors.size() + unrecorded.size() == truth.columns().size());
  for (const ColumnError& e : errors) {
    CAPTURE(e.name, e.error, e.size);
    CHECK(e.error <= limit(e));
  }
}

}  // namespace

// One coordinate, quadruple precision. At tolerance 1e-10.
TEST_CASE("the spatial slider-crank agrees with its reference over eight revolutions", "[verification][joints]") {
  const std::string name = GENERATE(as<std::string>(), "spatial_slider_crank", "spatial_slider_crank_crank_at_A");
  CAPTURE(name);
  const SceneRun run = run_scene(scene_path(name));
  const Table truth = trusted(name);
  check_columns(run.table, truth, {"dx", "dy", "dz"},
                [](const ColumnError& e) { return 1e-9 * std::max(1.0, e.size); });
  double worst = 0, balance = 0;  // the unit vector from C to B
  for (std::size_t i = 0; i < truth.n_rows(); ++i) {
    for (const char axis : {'x', 'y', 'z'}) {
      const std::string d = std::string("d") + axis, b = std::string(1, axis) + "b", c = std::string(1, axis) + "c_rod";
      keep_worst(worst, std::abs((run.table[b][i] - run.table[c][i]) / 0.15 - truth[d][i]));
    }
    keep_worst(balance, std::abs(run.table["balance"][i]));
  }
  CHECK(worst <= 1e-10);
  CHECK(balance <= 1e-9);
}

// Closed form. Driven: whatever the step; in the plane and in space.
TEST_CASE("the linkage of Peaucellier draws a straight line", "[verification][joints]") {
  const bool planar = GENERATE(true, false), rk4 = GENERATE(false, true);
  CAPTURE(planar, rk4);
  const SceneRun run = run_scene(
      scene_path("peaucellier"),
      [&](RunSettings& r) {
        if (rk4) r.integrator = {"rk4"}, r.step = 2.5e-3;
        if (!planar) r.solver = {"sparse"};
      },
      [&](Scene& s) {
        if (!planar) s.root = s.root.without({"planar"}), s = in_space(s);
      });
  CHECK(run.n_velocities == (planar ? 21 : 42));
  const Table truth = trusted("peaucellier");
  check_columns(run.table, truth, {}, [&](const ColumnError& e) {
    const bool rate = e.name.find("_d") != std::string::npos || e.name == "drive_torque";
    return rate ? 1e-9 * std::max(1.0, e.size) : rk4 ? 1e-10 : 1e-11;
  });
  double worst = 0;
  for (const double x : run.table["Px"]) keep_worst(worst, std::abs(x - 0.525));
  CHECK(worst <= (rk4 ? 1e-10 : 1e-12));
}

namespace {

// Pose law of the reference page: centre and R = Rz Ry Rx.
template <class T>
struct TurnRates {
  T z, y, x;
};
template <class T>
TurnRates<T> turns(const T& t) {
  return {0.2 * sin(t), 0.15 * sin(2.0 * t + 0.5), 0.1 * sin(3.0 * t + kPi / 2)};
}
template <class T>
std::array<T, 3> centre(const T& t) {
  return {0.1 * sin(2.0 * t), 0.15 * sin(3.0 * t + 1.0), 1.2 + 0.1 * sin(1.5 * t)};
}
/// b in the platform, in the world.
template <class T>
std::array<T, 3> point(const T& t, const Vec3& b) {
  const TurnRates<T> a = turns(t);
  const std::array<T, 3> c = centre(t);
  const T y1 = b[1] * cos(a.x) - b[2] * sin(a.x), z1 = b[1] * sin(a.x) + b[2] * cos(a.x);
  const T x2 = b[0] * cos(a.y) + z1 * sin(a.y), z2 = z1 * cos(a.y) - b[0] * sin(a.y);
  return {c[0] + x2 * cos(a.z) - y1 * sin(a.z), c[1] + x2 * sin(a.z) + y1 * cos(a.z), c[2] + z2};
}
Vec3 ring(double radius, double degrees, double z) {
  return {radius * std::cos(degrees * kPi / 180), radius * std::sin(degrees * kPi / 180), z};
}

Vec3 three(const Table& truth, const char* x, const char* y, const char* z, std::size_t i) {
  return {truth[x][i], truth[y][i], truth[z][i]};
}
Quat quaternion(const Table& truth, std::size_t i) {
  return Quat{truth["qw"][i], truth["qx"][i], truth["qy"][i], truth["qz"][i]};
}

/// A platform on six legs of the lengths that the pose law gives, exactly.
Body& add_platform(System& system, const Table& truth) {
  const double kBase[] = {-10, 10, 110, 130, 230, 250}, kPlatform[] = {-50, 50, 70, 170, 190, 290};
  Body& platform = system.add_body("platform", MassProperties{10.0, Vec3::Zero(), Vec3(0.6, 0.7, 1.1).asDiagonal()},
                                   {three(truth, "x", "y", "z", 0), quaternion(truth, 0)});
  platform.start = {three(truth, "vx", "vy", "vz", 0),
                    rotation(quaternion(truth, 0)).transpose() * three(truth, "wx", "wy", "wz", 0)};
  for (int k = 0; k < 6; ++k) {
    const Vec3 a = ring(1, kBase[k], 0), b = ring(0.5, kPlatform[k], -0.05);
    const auto length = laws::law([a, b](auto t) {
      const auto p = point(t, b);
      const auto x = p[0] - a[0], y = p[1] - a[1], z = p[2] - a[2];
      return sqrt(x * x + y * y + z * z);
    });
    const std::string n = std::to_string(k + 1);
    system.add<Distance>("leg " + n, system.add_marker("b" + n, platform, {b, Quat{}}),
                         system.add_marker("a" + n, system.ground(), {a, Quat{}}), length);
    double worst = 0;  // the law itself
    for (std::size_t i = 0; i < truth.n_rows(); ++i) {
      const LawValue l = length->at(truth["t"][i]);
      keep_worst(worst, std::abs(l.y - truth["L" + n][i]));
      keep_worst(worst, std::abs(l.yd - truth["L" + n + "_d"][i]));
      keep_worst(worst, std::abs(l.ydd - truth["L" + n + "_dd"][i]));
    }
    CHECK(worst <= 1e-13);
  }
  return platform;
}

/// How far a platform is from its reference at row i.
struct Apart {
  double position = 0, turn = 0, speed = 0, force = 0;
  void take(const Body& platform, const State& s, const VecX& lambda, const Table& truth, std::size_t i) {
    const Pose p = body_pose(platform, s);
    const Twist v = body_twist(platform, s);
    const Quat off = conjugate(quaternion(truth, i)) * p.q;
    keep_worst(position, (p.x - three(truth, "x", "y", "z", i)).norm());
    keep_worst(turn, 2 * off.vec().norm());
    keep_worst(speed, (v.v - three(truth, "vx", "vy", "vz", i)).norm());
    keep_worst(speed, (rotation(p.q) * v.w - three(truth, "wx", "wy", "wz", i)).norm());
    for (int k = 0; k < 6; ++k)  // a multiplier above zero pulls, f pushes
      keep_worst(force, std::abs(lambda[k] + truth["f" + std::to_string(k + 1)][i]));
  }
};

}  // namespace

// Closed form: legs of the lengths that the pose law gives; the platform must follow, its legs push as Newton and Euler say.
TEST_CASE("a Stewart platform stands where its legs are long enough for, and they push as they should",
          "[verification][joints]") {
  const Table truth = trusted("stewart");
  System system({.gravity = Vec3(0, 0, -9.81)});
  const Body& platform = add_platform(system, truth);
  Registry registry = builtin_registry();
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  const bool rk4 = GENERATE(false, true);
  RunSettings settings;
  settings.integrator = {rk4 ? "rk4" : "dop853"};
  if (rk4) settings.step = 0.005;
  StepLoop simulation(dynamics, make_integrator(settings, registry),
                        {.step = settings.step, .tolerance = {1e-10, 1e-12}});
  Apart apart;
  for (std::size_t i = 0; i < truth.n_rows(); ++i) {
    if (i > 0) simulation.run_until(truth["t"][i]);
    const State& s = simulation.state();
    apart.take(platform, s, dynamics.evaluate(s).lambda, truth, i);
  }
  CAPTURE(rk4, apart.position, apart.turn, apart.speed, apart.force);
  CHECK(apart.position <= (rk4 ? 1e-10 : 1e-11));
  CHECK(apart.turn <= (rk4 ? 1e-10 : 1e-11));
  CHECK(apart.speed <= 1e-9);
  CHECK(apart.force <= 1e-9 * 120);
}

// The same without integration: pose, speeds and the forces of the legs from the lengths alone.
TEST_CASE("inverse dynamics of a Stewart platform: the forces of its legs", "[verification][joints][kinematics]") {
  const Table truth = trusted("stewart");
  System system({.gravity = Vec3(0, 0, -9.81)});
  const Body& platform = add_platform(system, truth);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  DrivenMotion motion(dynamics, system.start());
  Apart apart;
  for (std::size_t i = 0; i < truth.n_rows(); ++i) {
    const VecX lambda = motion.to(truth["t"][i]).lambda;
    apart.take(platform, motion.state(), lambda, truth, i);
  }
  CAPTURE(apart.position, apart.turn, apart.speed, apart.force);
  CHECK(apart.position <= 1e-11);
  CHECK(apart.turn <= 1e-11);
  CHECK(apart.speed <= 1e-10);
  CHECK(apart.force <= 1e-9 * 120);
}

// The scene takes its lengths from a table: a quintic spline between 81 points.
TEST_CASE("the Stewart platform of the scene follows its table", "[verification][joints]") {
  const SceneRun run = run_scene(scene_path("stewart"));
  const Table truth = trusted("stewart");
  check_columns(run.table, truth,
                {"L1",    "L2",    "L3",    "L4",    "L5",    "L6",    "L1_d", "L2_d", "L3_d", "L4_d", "L5_d", "L6_d",
                 "L1_dd", "L2_dd", "L3_dd", "L4_dd", "L5_dd", "L6_dd", "f1",   "f2",   "f3",   "f4",   "f5",   "f6"},
                [](const ColumnError& e) {
                  return e.name[0] == 'v' || e.name[0] == 'w' ? 1e-7 : 1e-10;  // at the points the spline is exact
                });
  for (int k = 1; k <= 6; ++k) {
    const std::string n = std::to_string(k);
    double worst = 0;
    for (std::size_t i = 0; i < truth.n_rows(); ++i)
      keep_worst(worst, std::abs(run.table["lambda_" + n][i] + truth["f" + n][i]));
    CAPTURE(k);
    CHECK(worst <= 1e-4);
  }
}

}  // namespace references_of_joints_test
