// SPDX-License-Identifier: BSD-3-Clause
// Equilibria from far away, against closed forms (tests/verification/data/modes_states.csv), least energies found
// otherwise, and steady rotation by forces of the user's own.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/equilibrium.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"

namespace statics_test {

using namespace lockstep;
using Kind = Stability::Kind;

namespace {

double exact(const std::string& name, const std::string& quantity) {
  std::ifstream file(std::filesystem::path(paths::kSource) / "tests/verification/data/modes_states.csv");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name + "," + quantity + ",")) return std::stod(line.substr(line.rfind(',') + 1));
  FAIL("no " << quantity << " of " << name);
  return 0;
}

MassProperties plain(double mass, const Vec3& J, const Vec3& center = Vec3::Zero()) {
  return {mass, center, J.asDiagonal()};
}
Quat turned(double angle) { return axis_angle(Vec3::UnitZ(), angle); }
Vec3 along(double angle, double length) { return {length * std::cos(angle), length * std::sin(angle), 0}; }
double angle_of(const Body& body, const State& state) {
  const Vec3 x = rotation(body_pose(body, state).q).col(0);
  return std::atan2(x[1], x[0]);
}

/// A uniform rod from `from` at an angle in the xy plane: x along it.
Body& rod(System& sys, const std::string& name, double mass, const Vec3& from, double angle, double length,
          double axial) {
  const double J = mass * length * length / 12;
  return sys.add_body(name, plain(mass, Vec3(axial, J, J)), {from + along(angle, 0.5 * length), turned(angle)});
}

/// What rests, with what was found.
struct AtRest {
  Dynamics dynamics;
  State state;
  EquilibriumReport report;

  explicit AtRest(System& sys, const EquilibriumOptions& options = {})
      : dynamics(sys, std::make_unique<SchurSolver>()), state(sys.start()) {
    assemble(dynamics, state);
    report = find_equilibrium(dynamics, state, options);
  }
  /// On p's body about P.
  LinkWrench reaction(const Lock& link) {
    const Evaluation& e = dynamics.gather(state);
    const MarkerFrame at(*link.pairs().front().first);
    return Reactions(e.rows(), {report.lambda.data(), static_cast<std::size_t>(report.lambda.size())})
        .on_body_of(at, link, e.inputs());
  }
};

/// Three rods between two supports, from these angles, which need not reach the second support.
struct Chain {
  System sys{{.gravity = {0, -9.81, 0}}};
  std::vector<Body*> rods;

  Chain(bool spherical, double a, double b, double c) {
    const double angle[] = {a, b, c}, length[] = {1, 0.8, 1.2}, mass[] = {1, 0.8, 1.5};
    Vec3 x = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      rods.push_back(&rod(sys, "rod " + std::to_string(k + 1), mass[k], x, angle[k], length[k], 0.001));
      Body& before = k == 0 ? sys.ground() : *rods[k - 1];
      join(spherical, "joint " + std::to_string(k + 1), *rods[k], before, pose_at(x), pose_at(x));
      x += along(angle[k], length[k]);
    }
    join(spherical, "end", *rods.back(), sys.ground(), pose_at(x), pose_at(Vec3(2.2, 0.4, 0)));
  }
  void join(bool spherical, const std::string& name, Body& p, Body& s, const Pose& at_p, const Pose& at_s) {
    Marker& P = sys.add_marker_at(name + ".P", p, at_p);
    Marker& S = sys.add_marker_at(name + ".S", s, at_s);
    if (spherical)
      sys.add<Spherical>(name, P, S);
    else
      sys.add<Revolute>(name, P, S);
  }
  void check(AtRest& found) {
    for (int k = 0; k < 3; ++k) {
      const std::string number = std::to_string(k + 1);
      CAPTURE(number);
      CHECK(std::abs(angle_of(*rods[k], found.state) - exact("chain_planar", "angle " + number)) <= 1e-11);
      const Vec3 x = body_pose(*rods[k], found.state).x;
      CHECK(std::abs(x[0] - exact("chain_planar", "centre " + number + " x")) <= 1e-11);
      CHECK(std::abs(x[1] - exact("chain_planar", "centre " + number + " y")) <= 1e-11);
      CHECK(std::abs(x[2]) <= 1e-9);
    }
    const Vec3 left = found.reaction(sys.link("joint 1")).force, right = found.reaction(sys.link("end")).force;
    CHECK(std::abs(left[0] - exact("chain_planar", "force of left support on chain x")) <= 1e-9);
    CHECK(std::abs(left[1] - exact("chain_planar", "force of left support on chain y")) <= 1e-9);
    CHECK(std::abs(right[0] - exact("chain_planar", "force of right support on chain x")) <= 1e-9);
    CHECK(std::abs(right[1] - exact("chain_planar", "force of right support on chain y")) <= 1e-9);
  }
};

}  // namespace

TEST_CASE("statics: a chain of three rods, from an arch, from a heap, from a start that does not close",
          "[verification][statics]") {
  struct Start {
    double a, b, c;
  };
  for (const bool spherical : {false, true})
    for (const Start& s : {Start{0.9, 0.1, -0.8}, Start{-0.7, 0.1, 0.9}, Start{1.5, -1.4, 0.3}, Start{0, 0, 0}}) {
      CAPTURE(spherical, s.a, s.b, s.c);
      Chain chain(spherical, s.a, s.b, s.c);
      AtRest found(chain.sys);
      chain.check(found);
      CHECK(found.report.unbalanced <= 1e-12);
      CHECK(found.report.stability.kind == (spherical ? Kind::neutral : Kind::stable));
      CHECK(found.report.stability.freedoms == (spherical ? 6 : 1));
      CHECK(found.report.stability.neutral.size() == (spherical ? 3 : 0));  // spin of each rod
      const double softest = spherical ? 3.8166238479845737 : 5.4353376961061493;
      CHECK(std::abs(std::sqrt(found.report.stability.softest) - softest) <= 1e-9);
    }
}

TEST_CASE("statics: dynamic relaxation finds what Newton's method is not left the iterations for",
          "[verification][statics]") {
  Chain chain(false, 0.9, 0.1, -0.8);
  AtRest found(chain.sys, {.iterations = 3});
  chain.check(found);
  CHECK(found.report.relaxed);
  CHECK(found.report.relaxation_steps > 0);
  CHECK(found.report.method().starts_with("dynamic relaxation"));
}

namespace {

/// The four-bar of four_bar_stable at a crank angle, on the branch with C left of B -> D, in space.
struct FourBar {
  System sys{{.gravity = {0, -9.81, 0}}};
  Body *crank, *coupler, *rocker;

  explicit FourBar(double theta) {
    const Vec3 A = Vec3::Zero(), Dg(0.28, 0, 0), B = along(theta, 0.1), BD = Dg - B;
    const double d = BD.norm(), beta = std::atan2(BD[1], BD[0]) + std::acos((0.09 + d * d - 0.0625) / (2 * 0.3 * d));
    const Vec3 C = B + along(beta, 0.3);
    const double phi = std::atan2(C[1], C[0] - 0.28);
    crank = &rod(sys, "crank", 0.5, A, theta, 0.1, 0.0001);
    coupler = &sys.add_body("coupler", plain(1.2, Vec3(0.006, 0.008, 0.011), Vec3(0.12, 0.04, 0)), {B, turned(beta)});
    rocker = &rod(sys, "rocker", 0.9, Dg, phi, 0.25, 0.0001);
    sys.add<Revolute>("A", *crank, sys.ground(), pose_at(A));
    sys.add<Revolute>("B", *coupler, *crank, pose_at(B));
    sys.add<Revolute>("C", *coupler, *rocker, pose_at(C));
    sys.add<Revolute>("D", *rocker, sys.ground(), pose_at(Dg));
    Marker& P = sys.add_marker_at("spring.P", *rocker, {Dg + along(phi, 0.2), {}});
    Marker& S = sys.add_marker_at("spring.S", sys.ground(), {Vec3(0.5, 0.1, 0), {}});
    sys.add<SpringDamper>("spring", P, S, {.stiffness = 300, .damping = 4, .free_length = 0.2});
  }
  void check(const std::string& name, const State& state) const {
    CHECK(std::abs(angle_of(*crank, state) - exact(name, "crank angle")) <= 1e-10);
    CHECK(std::abs(angle_of(*coupler, state) - exact(name, "coupler angle")) <= 1e-10);
    CHECK(std::abs(angle_of(*rocker, state) - exact(name, "rocker angle")) <= 1e-10);
  }
};

double exact_square(const std::string& name) { return exact(name, "reduced stiffness") / exact(name, "reduced mass"); }

}  // namespace

TEST_CASE("statics: a four-bar of four hinges on springs rests in its one stable position from any crank angle",
          "[verification][statics]") {
  for (double theta = -3; theta < 3.1; theta += 0.5) {
    CAPTURE(theta);
    FourBar four_bar(theta);
    const AtRest found(four_bar.sys);
    four_bar.check("four_bar_stable", found.state);
    CHECK(found.report.stability.kind == Kind::stable);
    CHECK(found.report.stability.freedoms == 1);
    CHECK(found.report.stability.softest == Approx(exact_square("four_bar_stable")).epsilon(1e-9));
  }
}

TEST_CASE("statics: the nearest equilibrium of a four-bar may be unstable, which is reported with its motion",
          "[verification][statics]") {
  FourBar four_bar(-2.8);
  const AtRest found(four_bar.sys, {.nearest = true});
  four_bar.check("four_bar_unstable", found.state);
  const Stability& s = found.report.stability;
  CHECK(s.kind == Kind::unstable);
  REQUIRE(s.unstable.size() == 1);
  CHECK(s.unstable.front().stiffness == Approx(exact_square("four_bar_unstable")).epsilon(1e-9));
  CHECK(s.unstable.front().words.find("'crank' rotates about ") != std::string::npos);
}

TEST_CASE("statics: a four-bar on springs has its two equilibria on each of its branches", "[verification][statics]") {
  FourBar four_bar(0.5);
  Dynamics dynamics(four_bar.sys, std::make_unique<SchurSolver>());
  const EquilibriaReport found = find_equilibria(dynamics, four_bar.sys.start(), {.starts = 60});
  int stable = 0, unstable = 0, starts = found.failed;
  for (const Equilibrium& e : found.all) {
    CHECK(e.report.unbalanced <= 1e-10);
    starts += e.found;
    for (const std::string name : {"four_bar_stable", "four_bar_unstable"}) {
      if (std::abs(angle_of(*four_bar.crank, e.state) - exact(name, "crank angle")) > 1e-6 ||
          std::abs(angle_of(*four_bar.rocker, e.state) - exact(name, "rocker angle")) > 1e-6)
        continue;
      four_bar.check(name, e.state);
      CHECK(e.report.stability.kind == (name == "four_bar_stable" ? Kind::stable : Kind::unstable));
      ++(name == "four_bar_stable" ? stable : unstable);
    }
  }
  CHECK(stable == 1);
  CHECK(unstable == 1);
  CHECK(found.starts == 61);
  CHECK(starts == found.starts);
}

TEST_CASE("statics: a standing pendulum is left for the hanging one, unless the nearest is asked for",
          "[verification][statics]") {
  for (const bool nearest : {false, true}) {
    System sys({.gravity = {0, -9.81, 0}});
    Body& bob = sys.add_body("bob", plain(2, Vec3(0.2, 0.25, 0.3)), {Vec3(0, 0.7, 0), {}});
    sys.add<Revolute>("pivot", bob, sys.ground(), pose_at(Vec3::Zero()));
    AtRest found(sys, {.nearest = nearest});
    const double square = 3.2756201702883685 * 3.2756201702883685, y = body_pose(bob, found.state).x[1];
    CHECK(y == Approx(nearest ? 0.7 : -0.7).epsilon(1e-12));
    if (nearest) {
      REQUIRE(found.report.stability.unstable.size() == 1);
      CHECK(found.report.stability.unstable.front().stiffness == Approx(-square).epsilon(1e-11));
      CHECK(found.report.stability.unstable.front().words == "'bob' rotates about z");
    } else {
      CHECK(found.report.left == std::vector<std::string>{"'bob' rotates about z"});
      CHECK(found.report.stability.softest == Approx(square).epsilon(1e-11));
    }
    CHECK((found.reaction(sys.link("pivot")).force - Vec3(0, 2 * 9.81, 0)).norm() <= 1e-9);
  }
}

// In axes that turn with the shaft a steady rotation is rest under centrifugal forces, given here as a force of the
// user's own. Without Coriolis terms in the arms' plane the frequencies are the governor's own.
TEST_CASE("statics: a governor in rotating axes rests at its steady rotation", "[verification][statics]") {
  static constexpr double kSpin = 8;
  System sys({.gravity = {0, 0, -9.81}});
  Body& shaft = sys.add_body("shaft", plain(0.3, Vec3::Constant(0.02)));
  Body& slider = sys.add_body("slider", plain(3, Vec3::Constant(0.005)), {Vec3(0, 0, 0.3), {}});
  sys.add<Revolute>("bearing", shaft, sys.ground(), pose_at(Vec3::Zero())).drive(Axis::rz, laws::constant(0.0));
  sys.add<Prismatic>("guide", slider, shaft, pose_at(Vec3(0, 0, 0.3)));
  std::vector<const Marker*> markers;
  std::vector<const Body*> arms;
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "right" : "left";
    const double alpha = 1.2;  // far from where it rests
    const Vec3 hinge(0.05 * side, 0, 1), x(side * std::cos(alpha), 0, -std::sin(alpha)), y(0, side, 0);
    Mat3 A;
    A << x, y, cross(x, y);
    Body& arm = sys.add_body(name, plain(2, Vec3(0.01, 0.12, 0.125)), {hinge + 0.8 * x, quaternion_of(A)});
    sys.add<Revolute>(name + " joint", arm, shaft, pose_at(hinge, Vec3(y)));
    Marker& P = sys.add_marker_at(name + ".P", arm, {hinge + 0.5 * x, {}});
    Marker& S = sys.add_marker_at(name + ".S", slider, {Vec3(0.05 * side, 0, 0.3), {}});
    sys.add<SpringDamper>(name + " spring", P, S, {.stiffness = 2000, .free_length = 0.5});
    markers.push_back(&sys.add_marker(name + ".centre", arm));
    arms.push_back(&arm);
  }
  sys.add(function_force("centrifugal", markers, [&sys](const Inputs& in, WrenchSum& out) {
    const Vec3 spin(0, 0, kSpin);
    for (int k = 0; k < sys.n_slots(); ++k) {
      const Motion& m = in.slot(k);
      out.force(k, -sys.slot(k).mass * cross(spin, cross(spin, m.x)), m.x);
      const Mat3 J = m.A * sys.slot(k).J * m.A.transpose();
      out.torque(k, -cross(spin, Vec3(J * spin)));
    }
  }));
  AtRest found(sys);
  const std::string name = "governor_revolute_free";
  CHECK(std::abs(body_pose(slider, found.state).x[2] - exact(name, "s")) <= 1e-10);
  for (const Body* arm : arms) {
    const Vec3 out = rotation(body_pose(*arm, found.state).q).col(0);
    CHECK(std::abs(std::asin(-out[2]) - exact(name, "alpha")) <= 1e-10);
  }
  CHECK(found.report.stability.kind == Kind::stable);
  CHECK(std::sqrt(found.report.stability.softest) == Approx(5.6814039257355262).epsilon(1e-7));  // by differences
}

namespace {

/// Least value of V over two angles: the best point of a grid, then again around it, finer and finer.
std::pair<double, double> least(const std::function<double(double, double)>& V) {
  double a = 0, b = 0, span = kPi;
  for (; span > 1e-9; span *= 0.5) {
    double best = V(a, b), at_a = a, at_b = b;
    for (int i = -20; i <= 20; ++i)
      for (int j = -20; j <= 20; ++j)
        if (const double v = V(a + span * i / 20, b + span * j / 20); v < best)
          best = v, at_a = a + span * i / 20, at_b = b + span * j / 20;
    a = at_a, b = at_b;
  }
  return {a, b};
}

}  // namespace

TEST_CASE("statics: two rods on a spring rest at the least energy that a search finds", "[verification][statics]") {
  for (const double first : {0.2, 2.0, -2.5}) {
    CAPTURE(first);
    System sys({.gravity = {0, -9.81, 0}});
    Body& one = rod(sys, "one", 1, Vec3::Zero(), first, 1, 0.01);
    Body& two = rod(sys, "two", 0.7, along(first, 1), 0.4, 0.8, 0.01);
    sys.add<Revolute>("A", one, sys.ground(), pose_at(Vec3::Zero()));
    sys.add<Revolute>("B", two, one, pose_at(along(first, 1)));
    Marker& P = sys.add_marker_at("tip", two, {along(first, 1) + along(0.4, 0.8), {}});
    Marker& S = sys.add_marker_at("wall", sys.ground(), {Vec3(1.5, 0.5, 0), {}});
    sys.add<SpringDamper>("spring", P, S, {.stiffness = 40, .free_length = 0.1});
    const AtRest found(sys);
    const auto V = [](double a, double b) {
      const Vec3 tip = along(a, 1) + along(b, 0.8);
      const double l = (tip - Vec3(1.5, 0.5, 0)).norm() - 0.1;
      return 9.81 * (0.5 * std::sin(a) + 0.7 * (std::sin(a) + 0.4 * std::sin(b))) + 20 * l * l;
    };
    const auto [a, b] = least(V);
    CHECK(found.report.stability.kind == Kind::stable);
    CHECK(std::abs(angle_of(one, found.state) - a) <= 1e-6);
    CHECK(std::abs(angle_of(two, found.state) - b) <= 1e-6);
  }
}

TEST_CASE("statics: what nothing holds is named", "[verification][statics]") {
  System falls({.gravity = {0, 0, -9.81}});
  falls.add_body("crate", plain(2, Vec3::Constant(0.1)));
  std::string words;
  try {
    const AtRest found(falls);
  } catch (const SolveError& error) {
    words = error.what();
  }
  CHECK(words.find("no equilibrium") != std::string::npos);
  CHECK(words.find("'crate' moves along -z, and nothing holds it") != std::string::npos);

  System turns({.gravity = {0, -9.81, 0}});  // balanced: a wheel on its axle
  Body& wheel = turns.add_body("wheel", plain(2, Vec3::Constant(0.1)));
  turns.add<Revolute>("axle", wheel, turns.ground(), pose_at(Vec3::Zero()));
  const AtRest found(turns);
  CHECK(found.report.stability.kind == Kind::neutral);
  REQUIRE(found.report.stability.neutral.size() == 1);
  CHECK(found.report.stability.neutral.front().words == "'wheel' rotates about z");
}

TEST_CASE("statics: an arm rests on its stop, or free of it", "[verification][statics]") {
  for (const double low : {-0.5, -2.5}) {
    CAPTURE(low);
    const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
      "bodies": [{"name": "arm", "mass": 2, "inertia": [0.1, 0.1, 0.1], "center": [0.5, 0, 0]}],
      "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0], "axis": "z",
                 "stops": [{"axis": "rz", "low": )" +
                             std::to_string(low) + R"(, "high": 1}]}]})";
    Mechanism m = build_mechanism(scene_from_text(text, "arm.json"), builtin_registry());
    AtRest found(system_of(m));
    const double rests = std::max(low, -kPi / 2);
    CHECK(std::abs(angle_of(m.system.body("arm"), found.state) - rests) <= 1e-10);
    CHECK(found.report.pressed == (low > -1 ? std::vector<std::string>{"A.stop_rz_low"} : std::vector<std::string>{}));
    const Vec3 moment = found.reaction(m.system.link("A.stop_rz_low")).moment;
    CHECK(std::abs(moment[2] - (low > -1 ? 2 * 9.81 * 0.5 * std::cos(low) : 0.0)) <= 1e-9);
  }
}

// A start on the wrong side of what holds it: the stop that the start touches would pull, and is released.
TEST_CASE("statics: a stop that would pull is released", "[verification][statics]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "arm", "mass": 2, "inertia": [0.1, 0.1, 0.1], "center": [0.5, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0], "axis": "z",
               "stops": [{"axis": "rz", "high": 0}]}]})";
  Mechanism m = build_mechanism(scene_from_text(text, "arm.json"), builtin_registry());
  const AtRest found(system_of(m));
  CHECK(std::abs(angle_of(m.system.body("arm"), found.state) + kPi / 2) <= 1e-10);
  CHECK(found.report.pressed.empty());
  CHECK(found.report.free == std::vector<std::string>{"A.stop_rz_high"});
}

// The spring is 1e12 times as stiff per mass as the pendulum is unstable.
TEST_CASE("statics: a light part on a stiff spring hides no unstable motion of another part",
          "[verification][statics]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "tip", "mass": 0.001, "inertia": [1e-6, 1e-6, 1e-6], "position": [1, 0, 0]},
               {"name": "rod", "mass": 1, "inertia": [0.1, 0.1, 0.1], "center": [0, 0.5, 0]}],
    "links": [{"name": "G", "type": "prismatic", "p": "tip", "s": "ground", "at": [1, 0, 0], "axis": [1, 0, 0]},
              {"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "tip", "s": "ground", "at_p": [1, 0, 0], "at_s": [3, 0, 0],
                "stiffness": 1e9, "free_length": 2}]})";
  for (const bool nearest : {true, false}) {
    Mechanism m = build_mechanism(scene_from_text(text, "stiff.json"), builtin_registry());
    const AtRest found(system_of(m), {.nearest = nearest});
    const Stability& s = found.report.stability;
    const double square = 9.81 * 0.5 / (0.1 + 0.25);  // m g s/(J + m s^2)
    CAPTURE(nearest);
    CHECK(s.kind == (nearest ? Kind::unstable : Kind::stable));
    CHECK(s.neutral.empty());
    if (nearest) {
      REQUIRE(s.unstable.size() == 1);
      CHECK(s.unstable.front().stiffness == Approx(-square).epsilon(1e-9));
      CHECK(s.unstable.front().words == "'rod' rotates about z");
    } else {
      CHECK(s.softest == Approx(square).epsilon(1e-9));
      CHECK(found.report.left == std::vector<std::string>{"'rod' rotates about z"});
      CHECK(rotation(body_pose(m.system.body("rod"), found.state).q)(1, 1) == Approx(-1).epsilon(1e-9));
    }
  }
}

// The damper takes up what the spring gives: k (l - l0) = d v at v = 1 m/s of the marker.
TEST_CASE("statics: a note names a marker that a law moves under a damper", "[verification][statics]") {
  const std::string text = R"({"lockstep": 1,
    "bodies": [{"name": "b", "particle": 1, "position": [1.3, 0, 0]}],
    "markers": [{"name": "M", "body": "ground", "translation": {"type": "components",
                 "x": {"type": "polynomial", "coefficients": [0, 1]}}}, {"name": "P", "body": "b"}],
    "links": [{"name": "G", "type": "point_on_line", "p": "b", "s": "ground", "at": [1.3, 0, 0], "axis": [1, 0, 0]}],
    "forces": [{"name": "s", "type": "spring_damper", "p": "P", "s": "M", "stiffness": 123, "damping": 10,
                "free_length": 1.1}]})";
  Mechanism m = build_mechanism(scene_from_text(text, "marker.json"), builtin_registry());
  const AtRest found(system_of(m));
  CHECK(texts_of(found.report.notes) ==
        std::vector<std::string>{"marker 'M' moves by a law: dampers on it act by its velocity at that time"});
  CHECK(body_pose(m.system.body("b"), found.state).x[0] == Approx(1.1 + 10.0 / 123).epsilon(1e-10));
}

TEST_CASE("statics: revolutions are counted from pose to pose", "[verification][statics]") {
  const auto at_rest = [](const std::string& hinge, const std::string& members) {
    const std::string text = R"({"lockstep": 1, "gravity": [0, 0, 0],
      "bodies": [{"name": "arm", "mass": 2, "inertia": [0.1, 0.1, 0.1], "center": [0.5, 0, 0]}],
      "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "ground", "at": [0, 0, 0], "axis": "z")" +
                             hinge + R"(}], "forces": [{"name": "m", "type": "torque_motor", "p": "arm", "s": "ground",
                 "at": [0, 0, 0], "torque": 7})" +
                             members + "]}";
    Mechanism m = build_mechanism(scene_from_text(text, "arm.json"), builtin_registry());
    const AtRest found(system_of(m));
    return std::make_pair(found.report.pressed, angle_of(m.system.body("arm"), found.state));
  };
  const auto spring = at_rest("", R"(, {"name": "s", "type": "torsion_spring_damper", "p": "arm", "s": "ground",
    "at": [0, 0, 0], "stiffness": 0.5})");
  CHECK(std::remainder(spring.second - 7 / 0.5, kTwoPi) == Approx(0).margin(1e-9));
  const auto stop = at_rest(R"(, "stops": [{"axis": "rz", "low": "-10 deg", "high": "400 deg"}])", "");
  CHECK(stop.first == std::vector<std::string>{"A.stop_rz_high"});
  CHECK(stop.second == Approx(40 * kPi / 180).margin(1e-9));
}

}  // namespace statics_test
