// SPDX-License-Identifier: BSD-3-Clause
// Modes: closed forms, other world frames and orders of the links, sparse against dense; states that are refused.
#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <lockstep/dynamics.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/linearization.h>
#include <lockstep/modes.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/dense.h"
#include "tests/support/messages.h"
#include "tests/support/modes_bench.h"

namespace modes_forms_test {

using namespace lockstep;
using namespace lockstep::testing;
using namespace lockstep::modes_bench;

TEST_CASE("modes: a pendulum's frequency, and its shape", "[verification][modes][linear]") {
  const double m = 2, d = 0.7, I = 0.3, g = 9.81;
  System sys({.gravity = {0, -g, 0}});
  Body& bob = sys.add_body("bob", {m, Vec3::Zero(), Vec3(0.2, 0.25, I).asDiagonal()}, {Vec3(0, -d, 0), {}});
  sys.add<Revolute>("pivot", bob, sys.ground(), pose_at(Vec3::Zero()));
  const Modes modes = modes_of(sys);
  REQUIRE(modes.modes.size() == 1);
  const Mode& swing = modes.modes.front();
  CHECK(swing.omega() == Approx(std::sqrt(m * g * d / (I + m * d * d))).epsilon(1e-13));
  CHECK(swing.frequency() == Approx(swing.omega() / kTwoPi));
  CHECK(swing.damping() == 0);
  CHECK(swing.kind == Mode::Kind::oscillation);
  REQUIRE(swing.shape.size() == 1);
  CHECK(std::abs(swing.shape[0].turn[2] - 1.0) <= 1e-12);
  CHECK(std::abs(swing.shape[0].move[0] - d) <= 1e-12);
  CHECK(std::abs(swing.shape[0].move[1]) <= 1e-12);
}

TEST_CASE("modes depend neither on the world's axes nor on the order of links", "[verification][modes][linear]") {
  const auto values = [](const Pose& world, bool reversed) {
    System sys;
    build_hanging(sys, world, reversed);
    return modes_of(sys).eigenvalues();
  };
  const std::vector<Complex> plain = values({}, false);
  CHECK(plain.size() == 8);
  for (const bool reversed : {false, true})
    check_same(values({Vec3(3, -20, 7), normalized(Quat{0.3, -0.5, 0.7, 0.1})}, reversed), plain, 1e-10);
}

TEST_CASE("modes: damping ratio of a mass on a spring, overdamped and not", "[verification][modes][linear]") {
  const double m = 1.3, k = 50;
  for (const double c : {0.7, 40.0}) {
    System sys;
    Body& mass = sys.add_body("mass", {m, Vec3::Zero(), Vec3::Constant(0.01).asDiagonal()}, {Vec3(1, 0, 0), {}});
    sys.add<Prismatic>("rail", mass, sys.ground(), pose_at(Vec3::Zero(), Vec3(Vec3::UnitX())));
    Marker& P = sys.add_marker_at("P", mass, pose_at(Vec3(1, 0, 0)));
    Marker& S = sys.add_marker_at("S", sys.ground(), pose_at(Vec3::Zero()));
    sys.add<SpringDamper>("spring", P, S, {.stiffness = k, .damping = c, .free_length = 1});
    const Modes modes = modes_of(sys);
    const Complex root = std::sqrt(Complex(c * c - 4 * k * m));
    check_same(modes.eigenvalues(), {(-c + root) / (2 * m), (-c - root) / (2 * m)}, 1e-12);
    if (c < 1) CHECK(modes.modes.front().damping() == Approx(c / (2 * std::sqrt(k * m))).epsilon(1e-12));
    if (c > 1) CHECK(modes.modes.front().kind == Mode::Kind::decay);
  }
}

// It z'' - i Iz w z' - m g d z = 0 of the tip z = x + iy, seen from axes at rest; from axes that turn with the top each l
// of the tip is less by i w.
TEST_CASE("modes of a sleeping top, from axes at rest and rotating", "[verification][modes][linear]") {
  const double m = 2, d = 0.3, Iz = 0.05, It = 0.04 + m * d * d, g = 9.81;
  for (const double w : {2.0, 120.0}) {
    System sys({.gravity = {0, 0, -g}});
    Body& top = sys.add_body("top", {m, Vec3::Zero(), Vec3(0.04, 0.04, Iz).asDiagonal()}, {Vec3(0, 0, d), {}});
    top.start.w = Vec3(0, 0, w);
    sys.add<Spherical>("tip", top, sys.ground(), pose_at(Vec3::Zero()));
    const Complex i(0, 1), root = std::sqrt(Complex(Iz * Iz * w * w - 4 * It * m * g * d));
    for (const double spin : {0.0, w}) {
      CAPTURE(w, spin);
      const Modes modes = modes_of(sys, {.motion = {.spin = Vec3(0, 0, spin)}});
      std::vector<Complex> truth(2, 0.0);  // it can turn about its axis, and drift there
      for (const Complex l : {i * (Iz * w + root) / (2 * It), i * (Iz * w - root) / (2 * It)})
        truth.push_back(l - i * spin), truth.push_back(std::conj(l - i * spin));
      check_same(modes.eigenvalues(), truth, 1e-10);
      CHECK(modes.zeros == 2);
      const bool stable = Iz * Iz * w * w > 4 * It * m * g * d;
      CHECK(std::ranges::all_of(modes.modes, [](const Mode& k) { return k.is_marginal(); }) == stable);
    }
  }
}

// Nutation about steady precession Om at the angle th, a = I3 w3/It: (a - 2 Om cos th)^2 + Om^2 sin^2 th.
TEST_CASE("modes of a top in steady precession, which is found from the state", "[verification][modes][linear]") {
  const double m = 2, d = 0.3, I3 = 0.05, It = 0.04 + m * d * d, g = 9.81, Om = 1.5, th = 0.5, c = std::cos(th);
  const double w3 = (m * g * d / Om + It * Om * c) / I3;
  System sys({.gravity = {0, 0, -g}});
  const Vec3 axis(std::sin(th), 0, c), w = Vec3(0, 0, Om) + (w3 - Om * c) * axis;
  const Quat q = axis_angle(Vec3::UnitY(), th);
  Body& top = sys.add_body("top", {m, Vec3::Zero(), Vec3(0.04, 0.04, I3).asDiagonal()}, {Vec3(d * axis), q});
  top.start.w = rotation(q).transpose() * w;
  top.start.v = cross(w, Vec3(d * axis));
  sys.add<Spherical>("tip", top, sys.ground(), pose_at(Vec3::Zero()));
  const Modes modes = modes_of(sys);
  CHECK((modes.spin - Vec3(0, 0, Om)).norm() <= 1e-11);
  CHECK(modes.zeros == 4);
  const double a = I3 * w3 / It, nutation = std::hypot(a - 2 * Om * c, Om * std::sin(th));
  check_same(modes.eigenvalues(), {0.0, 0.0, 0.0, 0.0, Complex(0, nutation), Complex(0, -nutation)}, 1e-10);
}

TEST_CASE("modes: a state that is no equilibrium is rejected by name, or frozen on request",
          "[verification][modes][linear]") {
  System sys({.gravity = {0, -9.81, 0}});
  Body& arm = sys.add_body("arm", {2.0, Vec3::Zero(), Vec3::Constant(0.2).asDiagonal()}, {Vec3(0.5, 0, 0), {}});
  sys.add<Revolute>("pivot", arm, sys.ground(), pose_at(Vec3::Zero()));
  const std::string words = message_of<ModelError>([&] { modes_of(sys); });
  CHECK(says(words, {"'arm' accelerates at"}));
  CHECK(says(words, {"neither an equilibrium"}));
  const Modes frozen = modes_of(sys, {.motion = {.frozen = true}});
  CHECK_FALSE(frozen.unrest.is_still());
  const double load = 9.81 + 9.81 * (1 - 0.5 / 0.7);  // the weight, and what the pivot carries of it, over the mass
  CHECK(frozen.unrest.acceleration_limit == Approx(1e-6 * load).epsilon(1e-12));
  CHECK(frozen.unrest.speed_limit == Approx(1e-6 * std::sqrt(0.5 * load)).epsilon(1e-12));
  REQUIRE_FALSE(frozen.notes.empty());
  CHECK(says(frozen.notes.front().text(), {"frozen"}));

  // Through its lowest position a pendulum seems to turn steadily; a third of a revolution later it does not.
  System swinging({.gravity = {0, -9.81, 0}});
  Body& bob = swinging.add_body("bob", {2.0, Vec3::Zero(), Vec3::Constant(0.2).asDiagonal()}, {Vec3(0, -0.5, 0), {}});
  bob.start.w = Vec3(0, 0, 3), bob.start.v = Vec3(1.5, 0, 0);
  swinging.add<Revolute>("pivot", bob, swinging.ground(), pose_at(Vec3::Zero()));
  CHECK(says(message_of<ModelError>([&] { modes_of(swinging); }), {"a third of a revolution later"}));
}

// The hinge lies 0.5 m beside the mass centre and carries the moment of that, about the thin axis when it falls from the
// horizontal: much to an inertia of 1.6e-7 kg m^2, and nothing to the fall.
TEST_CASE("modes: no inertia is so small that a fall is called rest, nor rest a fall",
          "[verification][modes][linear]") {
  const double m = 2, d = 0.5, g = 9.81, across = m / 12;
  struct Case {
    Vec3 horizontal, vertical;  // inertias of the body along x, and along y
  };
  const double thin = 1.6e-7, small = 1e-6;
  for (const Case& c : {Case{Vec3(thin, across, across), Vec3(across, thin, across)},
                        Case{Vec3::Constant(small), Vec3::Constant(small)}})
    for (const Quat& turn : {Quat{1, 0, 0, 0}, normalized(Quat{0.3, -0.5, 0.7, 0.1})}) {
      const Mat3 A = rotation(turn);
      const auto build = [&](System& sys, const Vec3& x, const Vec3& J) {
        sys.set_gravity(A * Vec3(0, -g, 0));
        Body& rod = sys.add_body("rod", {m, Vec3::Zero(), J.asDiagonal()}, {Vec3(A * x), turn});
        sys.add<Revolute>("hinge", rod, sys.ground(), Pose{Vec3::Zero(), turn});
      };
      CAPTURE(c.horizontal.transpose(), turn.w);
      System falling;
      build(falling, Vec3(d, 0, 0.5), c.horizontal);
      Dynamics dynamics = dynamics_of(falling);
      CHECK(says(message_of<ModelError>([&] { find_modes(dynamics, falling.start()); }), {"'rod' accelerates at"}));
      CHECK(says(message_of<ModelError>([&] { linearize(dynamics, falling.start(), {}, {}); }),
                 {"'rod' accelerates at"}));
      const Modes frozen = modes_of(falling, {.motion = {.frozen = true}});
      CHECK(frozen.unrest.acceleration_limit <= 1e-2);

      System hanging;
      build(hanging, Vec3(0, -d, 0.5), c.vertical);
      const Modes modes = modes_of(hanging);
      CHECK(modes.unrest.is_still());
      REQUIRE(modes.modes.size() == 1);
      CHECK(modes.modes[0].omega() == Approx(std::sqrt(m * g * d / (c.vertical[2] + m * d * d))).epsilon(1e-8));
    }
}

// A rod under its weight between two hinges is held twice along its length; two rods in line between two balls lose rank
// in this pose only.
TEST_CASE("modes: a pose that loses rank is rejected, redundant constraints are not", "[verification][modes][linear]") {
  System line({.gravity = {0, 0, 0}});
  const MassProperties rod{1.0, Vec3::Zero(), Vec3(0.01, 0.08, 0.08).asDiagonal()};
  Body& a = line.add_body("a", rod, {Vec3(0.5, 0, 0), {}});
  Body& b = line.add_body("b", rod, {Vec3(1.5, 0, 0), {}});
  line.add<Revolute>("left", a, line.ground(), pose_at(Vec3::Zero()));
  line.add<Revolute>("middle", b, a, pose_at(Vec3(1, 0, 0)));
  line.add<Revolute>("right", b, line.ground(), pose_at(Vec3(2, 0, 0)));
  CHECK(says(message_of<ModelError>([&] { modes_of(line); }), {"in this pose only", "singular configuration"}));

  System held({.gravity = {0, -9.81, 0}});
  Body& door = held.add_body("door", {1.0, Vec3::Zero(), Vec3::Constant(0.05).asDiagonal()}, {Vec3(0, -0.4, 0), {}});
  held.add<Revolute>("one", door, held.ground(), pose_at(Vec3(0, 0, -0.2)));
  held.add<Revolute>("two", door, held.ground(), pose_at(Vec3(0, 0, 0.2)));
  const Modes modes = modes_of(held);
  REQUIRE(modes.modes.size() == 1);
  CHECK(modes.modes[0].omega() == Approx(std::sqrt(9.81 * 0.4 / (0.05 + 0.16))).epsilon(1e-12));
}

// In absolute angles the mass matrix of a chain and the stiffness of its weight are sums over the rods below a hinge.
TEST_CASE("modes of a chain of 300 hinges: sparse as dense, and as in absolute angles",
          "[verification][modes][linear]") {
  constexpr int n = 300;
  System sys({.gravity = {0, -9.81, 0}});
  sys.set_planar(Plane{2});
  build_chain(sys, n);
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  const Modes sparse = find_modes(dynamics, sys.start(), {.count = 12, .dense_limit = 0});
  const Modes all = find_modes(dynamics, sys.start(), {.count = 12, .dense_limit = 5000});
  REQUIRE(sparse.modes.size() == 12);
  REQUIRE(all.modes.size() == 12);
  CHECK(all.freedoms == n);
  for (std::size_t k = 0; k < 12; ++k) {
    CAPTURE(k);
    CHECK(std::abs(sparse.modes[k].value - all.modes[k].value) <= 1e-9 * std::abs(all.modes[k].value));
  }
  MatX M(n, n), K = MatX::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) M(i, j) = n - 1 - std::max(i, j) + 0.5;
    M(i, i) = n - 1 - i + 0.25 + 0.09;
    K(i, i) = 9.81 * (n - 1 - i + 0.5);
  }
  std::vector<double> squares;
  for (const Complex l : dense::eigenvalues(dense::solve(M, K))) squares.push_back(l.real());
  std::ranges::sort(squares);
  for (std::size_t k = 0; k < 12; ++k) CHECK(sparse.modes[k].omega() == Approx(std::sqrt(squares[k])).epsilon(1e-9));
}

// The light body's spring has a round-off of 1e8 N/m times the length, which says nothing of the heavy one.
TEST_CASE("modes: a light body on a stiff spring hides no residual acceleration of a heavy one",
          "[verification][modes][linear]") {
  for (const double force : {0.0, 0.1}) {
    System sys;
    Body& light = sys.add_body("light", shapes::sphere(0.01, 0.01), {Vec3(1, 0, 0), {}});
    Body& heavy = sys.add_body("heavy", shapes::sphere(100, 0.2), {Vec3(0, 1, 0), {}});
    sys.add<Prismatic>("rail", light, sys.ground(), pose_at({1, 0, 0}, Vec3::UnitX()));
    sys.add<SpringDamper>("spring", sys.add_marker("P", light), sys.add_marker("S", sys.ground()),
                          {.stiffness = 1e8, .free_length = 1});
    sys.add(function_force("push", {&sys.add_marker("at", heavy)}, [&heavy, force](const Inputs& in, WrenchSum& out) {
      out.force(heavy.slot, Vec3(force, 0, 0), in.slot(heavy.slot).x);
    }));
    Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
    CAPTURE(force);
    if (force == 0)
      CHECK_NOTHROW(find_modes(dynamics, sys.start()));
    else
      CHECK_THROWS_AS(find_modes(dynamics, sys.start()), ModelError);
  }
}

// In space three rows of the arch are redundant, and the sparse factor needs several corrections.
TEST_CASE("modes, sparse: a long loop as the dense solution", "[verification][modes][linear]") {
  constexpr int n = 60;
  const auto at = [](int i, double radius) -> Vec3 {
    return radius * Vec3(-std::cos(kPi * i / n), std::sin(kPi * i / n), 0);
  };
  System sys;
  Body* before = &sys.ground();
  for (int i = 0; i < n; ++i) {
    const std::string number = std::to_string(i);
    Body& rod = sys.add_body("rod_" + number, shapes::rod(1.0, at(i, 10), at(i + 1, 10)));
    sys.add<Revolute>("A" + number, rod, *before, pose_at(at(i, 10)));
    Marker& end = sys.add_marker_at("P" + number, rod, pose_at(at(i + 1, 10)));
    Marker& foot = sys.add_marker_at("S" + number, sys.ground(), pose_at(at(i + 1, 11)));
    if (i + 1 < n) sys.add<SpringDamper>("s" + number, end, foot, {.stiffness = 100.0 + i, .free_length = 1});
    before = &rod;
  }
  sys.add<Revolute>("Z", *before, sys.ground(), pose_at(at(n, 10)));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  const Modes sparse = find_modes(dynamics, sys.start(), {.count = 6, .dense_limit = 0});
  const Modes all = find_modes(dynamics, sys.start());
  CHECK(all.freedoms == n - 2);
  REQUIRE(sparse.modes.size() == 6);
  for (std::size_t k = 0; k < 6; ++k) {
    CAPTURE(k);
    CHECK(std::abs(sparse.modes[k].value - all.modes[k].value) <= 1e-8 * std::abs(all.modes[k].value));
  }
}

// A rod on a ball swings in two planes with w^2 = 3 g/(2 l), and turns about itself freely.
TEST_CASE("modes, sparse: equal modes are found with all their copies", "[verification][modes][linear]") {
  const auto [n, balls, count] = GENERATE(table<int, bool, int>({{5, true, 15}, {12, true, 36}, {210, false, 20}}));
  System sys({.gravity = {0, -9.81, 0}});
  for (int k = 0; k < n; ++k) {
    const std::string number = std::to_string(k);
    const MassProperties mass{1.0, Vec3::Zero(), Vec3(1.0 / 12, 1e-3, 1.0 / 12).asDiagonal()};
    Body& rod = sys.add_body("rod_" + number, mass, {Vec3(k, -0.5, 0), {}});
    if (balls)
      sys.add<Spherical>("A" + number, rod, sys.ground(), pose_at({1.0 * k, 0, 0}));
    else
      sys.add<Revolute>("A" + number, rod, sys.ground(), pose_at({1.0 * k, 0, 0}));
  }
  Dynamics dynamics(sys, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
  const Modes found = find_modes(dynamics, sys.start(), {.count = count, .dense_limit = n < 200 ? 0 : 1200});
  REQUIRE(found.modes.size() == static_cast<std::size_t>(count));
  const int free = balls ? n : 0;
  for (int k = 0; k < count; ++k) {
    CAPTURE(n, k);
    const double omega = found.modes[k].omega();
    if (k < free)
      CHECK(omega == 0);
    else
      CHECK(omega == Approx(std::sqrt(1.5 * 9.81)).epsilon(1e-9));
  }
}

namespace {

/// Masses on a line between two walls, with springs and dampers alike: M = m 1, D = c A, K = k A, and A has the values
/// 2 - 2 cos(j pi/(n + 1)).
void build_line(System& sys, int n, double m, double c, double k) {
  const auto at = [&](int i) -> Marker& {
    const std::string name = "m" + std::to_string(i);
    if (i == 0 || i == n + 1) return sys.add_marker_at(name, sys.ground(), pose_at({1.0 * i, 0, 0}));
    Body& body = sys.add_body("b" + std::to_string(i), MassProperties{m, Vec3::Zero(), Vec3(1, 1, 1).asDiagonal()},
                              {Vec3(i, 0, 0), {}});
    sys.add<Prismatic>("P" + std::to_string(i), body, sys.ground(), pose_at({1.0 * i, 0, 0}, Vec3::UnitX()));
    return sys.add_marker_at(name, body, pose_at({1.0 * i, 0, 0}));
  };
  Marker* before = &at(0);
  for (int i = 1; i <= n + 1; ++i) {
    Marker& next = at(i);
    sys.add<SpringDamper>("s" + std::to_string(i), *before, next, {.stiffness = k, .damping = c, .free_length = 1});
    before = &next;
  }
}

}  // namespace

TEST_CASE("modes, sparse: a damped line of masses has the modes of its closed form", "[verification][modes][linear]") {
  const double m = 2, k = 5e3;
  for (const double c : {1.0, 30.0, 4000.0}) {  // the last so much that high modes creep
    const int n = 240, count = 12;
    System sys;
    build_line(sys, n, m, c, k);
    Dynamics dynamics = dynamics_of(sys);
    const Modes found = find_modes(dynamics, sys.start(), {.count = count, .dense_limit = 0});
    std::vector<Complex> truth;
    for (int j = 1; j <= n; ++j) {
      const double a = 2 - 2 * std::cos(j * kPi / (n + 1));
      const Complex root = std::sqrt(Complex(c * a * c * a - 4 * m * k * a));
      for (const double sign : {1.0, -1.0}) {
        const Complex l = (-c * a + sign * root) / (2 * m);
        if (l.imag() >= 0) truth.push_back(l);
      }
    }
    std::ranges::sort(truth, {}, [](Complex l) { return std::abs(l); });
    REQUIRE(found.modes.size() == static_cast<std::size_t>(count));
    CHECK_FALSE(found.complete);
    for (int i = 0; i < count; ++i) {
      const Complex ours = found.modes[i].value;
      double off = HUGE_VAL;
      for (const Complex l : truth) off = std::min(off, std::abs(ours - l) / std::abs(l));
      CAPTURE(c, i, ours.real(), ours.imag());
      CHECK(off < 1e-8);
      CHECK(std::abs(ours) == Approx(std::abs(truth[i])).epsilon(1e-8));
    }
  }
}

// Rotors that hang on arms with universal joints, turned by drives, and tied to one another by springs with dampers:
// gyroscopic terms and damping.
TEST_CASE("modes, sparse: with spin and dampers as the dense solution", "[verification][modes][linear]") {
  System sys({.gravity = {0, 0, -9.81}});
  const int n = 60, count = 15;
  Marker* before = nullptr;
  for (int i = 0; i < n; ++i) {
    const std::string number = std::to_string(i);
    const double x = 0.5 * i;
    Body& arm = sys.add_body("arm" + number, MassProperties{0.1, Vec3::Zero(), Vec3(1e-3, 1e-3, 1e-3).asDiagonal()},
                             {Vec3(x, 0, -0.1), {}});
    Body& rotor = sys.add_body("rotor" + number, MassProperties{1.0, Vec3::Zero(), Vec3(0.01, 0.01, 0.02).asDiagonal()},
                               {Vec3(x, 0, -0.2), {}});
    rotor.start.w = {0, 0, 40};
    sys.add<Universal>("A" + number, arm, sys.ground(), pose_at({x, 0, 0}));
    sys.add<Revolute>("R" + number, rotor, arm, pose_at({x, 0, -0.2})).drive(Axis::rz, laws::law([](auto t) {
                                                                               return 40.0 * t;
                                                                             }));
    Marker& tip = sys.add_marker_at("tip" + number, arm, pose_at({x, 0, -0.2}));
    if (before != nullptr)
      sys.add<SpringDamper>("s" + number, *before, tip, {.stiffness = 20, .damping = 0.3, .free_length = 0.5});
    before = &tip;
  }
  Dynamics dynamics = dynamics_of(sys);
  const LinearMotionOptions still{.spin = Vec3::Zero()};
  const Modes dense = find_modes(dynamics, sys.start(), {.motion = still});
  const Modes sparse = find_modes(dynamics, sys.start(), {.motion = still, .count = count, .dense_limit = 0});
  REQUIRE(dense.freedoms == 2 * n);
  REQUIRE(sparse.modes.size() == static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < sparse.modes.size(); ++k) {
    const Complex ours = sparse.modes[k].value, theirs = dense.modes[k].value;
    CAPTURE(k, ours.real(), ours.imag(), theirs.real(), theirs.imag());
    CHECK(sparse.modes[k].kind == dense.modes[k].kind);
    CHECK(std::abs(ours - theirs) <= 1e-7 * std::abs(theirs) + dense.modes[k].bound + sparse.modes[k].bound);
  }
}

}  // namespace modes_forms_test
