// SPDX-License-Identifier: BSD-3-Clause
// Linear equations: against modes, and against small motions of the mechanism itself; what is refused; matrices.
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/linearization.h>
#include <lockstep/modes.h>
#include <lockstep/recorder.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/dense.h"
#include "tests/support/messages.h"
#include "tests/support/modes_bench.h"

namespace linear_test {

using namespace lockstep;
using namespace lockstep::testing;
using namespace lockstep::modes_bench;

namespace {

enum class By { push, drive, speed };

/// Two rods that hang from hinges, the upper one driven or free, a damper at the lower one. A law drives it, is its speed,
/// or pushes the free end.
struct DoubleRod {
  System sys{{.gravity = {0, -9.81, 0}}};
  DoubleRod(By by, const LawPtr<MotionLaw>& law) {
    const MassProperties rod{1.0, Vec3::Zero(), Vec3(0.08, 0.01, 0.085).asDiagonal()};
    Body& one = sys.add_body("one", rod, {Vec3(0, -0.5, 0), {}});
    Body& two = sys.add_body("two", rod, {Vec3(0, -1.5, 0), {}});
    Revolute& A = sys.add<Revolute>("A", one, sys.ground(), pose_at(Vec3::Zero()));
    sys.add<Revolute>("B", two, one, pose_at(Vec3(0, -1, 0)));
    Marker& end = sys.add_marker_at("end", two, pose_at(Vec3(0, -2, 0)));
    if (by == By::drive)
      A.drive(Axis::rz, law);
    else if (by == By::speed)
      A.drive_speed(Axis::rz, law);
    else
      sys.add(
          std::make_unique<AppliedForce>("push", end, AppliedForce::Options{.law = law, .direction = Vec3::UnitX()}));
    Marker& S = sys.add_marker_at("S", sys.ground(), pose_at(Vec3(1, -1.5, 0)));
    Marker& P = sys.add_marker_at("P", two, pose_at(Vec3(0, -1.5, 0)));
    sys.add<SpringDamper>("damper", P, S, {.stiffness = 0, .damping = 3, .free_length = 0});
  }
};

/// x of x' = A x + B u(t) from 0 by small steps of a classical Runge-Kutta method.
template <class U>
VecX linear_run(const StateSpace& s, U&& u, double until, int steps) {
  VecX x = VecX::Zero(s.A.rows());
  const double h = until / steps;
  const auto rate = [&](double t, const VecX& at) { return VecX(s.A * at + s.B * u(t)); };
  for (int k = 0; k < steps; ++k) {
    const double t = k * h;
    const VecX a = rate(t, x), b = rate(t + h / 2, x + h / 2 * a), c = rate(t + h / 2, x + h / 2 * b),
               d = rate(t + h, x + h * c);
    x += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return x;
}

}  // namespace

TEST_CASE("linear equations: eigenvalues of A are those of the modes", "[verification][linear]") {
  for (const By by : {By::push, By::drive, By::speed}) {
    DoubleRod rods(by, laws::constant(0));
    Dynamics dynamics = dynamics_of(rods.sys);
    const StateSpace s = linearize(dynamics, rods.sys.start(), {}, {});
    CHECK(s.states.size() == (by == By::push ? 4 : 2));
    check_same(dense::eigenvalues(s.A), modes_of(rods.sys).eigenvalues(), 1e-11);
  }
}

// The linear output differs from that of a small motion by the square of its size; by symmetry, where the damper does
// not break it, by the cube. Relative to its own change each channel is off by up to the size, and by less as that falls;
// a wrong column is off by as much at every size.
TEST_CASE("linear equations: the response to a push and to a drive is that of a small motion",
          "[verification][linear]") {
  const std::vector<std::string> names = {
      "two.x", "end.vx", "B.rz", "two.ax", "A.force_on_p_world_x", "two.omega_world_z"};
  const double until = 1.3;
  for (const By by : {By::push, By::drive, By::speed}) {
    const auto input = std::make_shared<InputLaw>();
    DoubleRod rods(by, input);
    std::vector<Channel> channels;
    for (const std::string& name : names) channels.push_back(make_channel(rods.sys, name));
    Dynamics dynamics = dynamics_of(rods.sys);
    const StateSpace s = linearize(dynamics, rods.sys.start(),
                                   {{"u",
                                     by == By::push    ? "N"
                                     : by == By::drive ? "rad"
                                                       : "rad/s",
                                     input}},
                                   channels);
    CHECK(s.accuracy <= 1e-8);
    REQUIRE(s.inputs.size() == (by == By::push ? 1 : by == By::drive ? 3 : 2));
    REQUIRE(s.states.size() == (by == By::push ? 4 : by == By::drive ? 2 : 3));
    CHECK(s.states.back().name.ends_with(by == By::speed ? "u" : "_d"));
    CHECK(s.inputs.front().unit == (by == By::push ? "N" : by == By::drive ? "rad" : "rad/s"));
    REQUIRE(s.B.cols() == static_cast<Eigen::Index>(s.inputs.size()));
    std::vector<double> before;
    for (const double size : {1e-2, 1e-3}) {
      const auto u = [&](double t) {  // (1 - cos 3t)^2 begins with rates that are zero
        const double c = std::cos(3 * t), n = std::sin(3 * t);
        const double all[] = {(1 - c) * (1 - c), 6 * n * (1 - c), 18 * (c * (1 - c) + n * n)};
        return VecX(size * Eigen::Map<const VecX>(all + (by == By::speed ? 1 : 0), s.B.cols()));
      };
      const VecX y = s.C * linear_run(s, u, until, 4000) + s.D * u(until);
      DoubleRod moving(by, laws::law([size, by](auto t) {
                         const auto x = 1.0 - cos(3.0 * t);
                         return by == By::speed ? 6.0 * size * sin(3.0 * t) * x : size * x * x;
                       }));
      Simulation run(moving.sys, {.integrator = "dop853", .tolerance = 1e-12, .output = until});
      const Table& table = run.record({names.begin(), names.end()});
      run.run_until(until);
      std::vector<double> apart;
      for (std::size_t k = 0; k < names.size(); ++k) {
        const double change = table.change(names[k]), linear = y[static_cast<Eigen::Index>(k)];
        CAPTURE(static_cast<int>(by), names[k], size, change, linear);
        CHECK(std::abs(change) > 1e-2 * size);
        apart.push_back(std::abs(change - linear) / std::abs(change));
        CHECK(apart[k] <= 30 * size);
        if (!before.empty()) CHECK(apart[k] <= std::max(0.2 * before[k], 1e-4));
      }
      before = apart;
    }
  }
}

TEST_CASE("linear equations reject inputs without effect and outputs that are integrals", "[verification][linear]") {
  DoubleRod rods(By::push, laws::constant(0));
  const std::vector<Channel> works = {make_channel(rods.sys, "damper.dissipated")};
  Dynamics dynamics = dynamics_of(rods.sys);
  CHECK(says(message_of<ModelError>([&] { linearize(dynamics, rods.sys.start(), {}, works); }), {"integrated state"}));
  const LinearInput nowhere{"A.rz", "rad", std::make_shared<InputLaw>()};
  CHECK(says(message_of<ModelError>([&] { linearize(dynamics, rods.sys.start(), {nowhere}, {}); }),
             {"'A.rz' has no effect"}));
}

TEST_CASE("matrices: M a + J^T lambda = f and J a = c, with names", "[verification][linear]") {
  System sys;
  build_hanging(sys, {Vec3(1, 2, 3), normalized(Quat{0.9, 0.2, -0.3, 0.1})}, false);
  Dynamics dynamics = dynamics_of(sys);
  State state = sys.start();
  state.v[3] = 0.4, state.v[10] = -0.7;
  const MechanismMatrices m = matrices_at(dynamics, state);
  CHECK((m.M * m.a + SparseMat(m.J.transpose()) * m.lambda - m.f).norm() <= 1e-11 * m.f.norm());
  CHECK((m.J * m.a - m.c).norm() <= 1e-11 * (1 + m.c.norm()));
  CHECK(m.unknowns.front().name == "one.vx");
  CHECK(m.unknowns.back().name == "two.wz");
  CHECK(m.unknowns.back().unit == "rad/s");
  CHECK(m.rows.front().substr(0, 2) == "A.");
  CHECK(m.J.rows() == 8);
  CHECK(m.J.cols() == 12);
}

}  // namespace linear_test
