// SPDX-License-Identifier: BSD-3-Clause
// Starts by coordinates and weights: the assembled start nearest to what was asked.
#include <cmath>
#include <limits>
#include <string>

#include <spdlog/fmt/fmt.h>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/four_bar_scene.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"

namespace nearest_start_test {

using namespace lockstep;
using testing::four_bar;

namespace {

struct Assembled {
  Mechanism m;
  State state;
  AssemblyReport report;
  explicit Assembled(const std::string& members)
      : m(build_mechanism(scene_from_text(R"({"lockstep": 1, )" + members + "}", "scene.json"), builtin_registry())) {
    Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
    state = m.system.start();
    report = assemble(dynamics, state, m.start_speeds, m.assembly);
  }
  Vec3 place(const std::string& body) const { return body_pose(m.system.body(body), state).x; }
  /// Angle of the body's x axis about z, rad.
  double angle(const std::string& body) const {
    const Vec3 x = rotation(body_pose(m.system.body(body), state).q).col(0);
    return std::atan2(x[1], x[0]);
  }
};

std::string two_points(const std::string& a, const std::string& b) {
  return R"("bodies": [{"name": "a", "particle": 1)" + a + R"(}, {"name": "b", "particle": 7, "position": [1, 0, 0])" +
         b + R"(}], "links": [{"name": "J", "type": "spherical", "p": "a", "s": "b"}])";
}

}  // namespace

// w_a x^2 + w_b (1 - x)^2 is least at x = w_b/(w_a + w_b), whatever the masses.
TEST_CASE("weights of starts share out a move", "[unit][assembly]") {
  const auto [a, b, x] =
      GENERATE(table<std::string, std::string, double>({{R"(, "start_weight": 3)", "", 0.25},
                                                        {"", R"(, "start_weight": 4)", 0.8},
                                                        {R"(, "start_weight": 2)", R"(, "start_weight": 2)", 0.5},
                                                        {R"(, "assembled": "exact")", "", 0},
                                                        {"", R"(, "assembled": "exact")", 1},
                                                        {R"(, "assembled": "free")", "", 1},
                                                        {"", R"(, "assembled": "free")", 0}}));
  const Assembled found(two_points(a, b));
  CAPTURE(a, b);
  CHECK(found.place("a")[0] == Approx(x).margin(1e-9));
  CHECK(found.place("b")[0] == Approx(x).margin(1e-9));
  CHECK(found.report.after < 1e-11);
}

// Six particles fill the slots before the body's own.
TEST_CASE("a start by an angle is met by a body that comes after particles", "[unit][assembly]") {
  std::string bodies;
  for (int k = 0; k < 6; ++k)
    bodies += fmt::format(R"({{"name": "p{0}", "particle": 1, "position": [{0}, 1, 0]}}, )", k);
  const Assembled found(R"("bodies": [)" + bodies + R"({"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0],
               "start": {"position": {"rz": 0.7}}}])");
  CHECK(found.angle("b") == Approx(0.7).margin(1e-9));
}

// The rocker's angle by the intersection of two circles.
TEST_CASE("a start by a joint's coordinate is met exactly", "[unit][assembly]") {
  const double asked = GENERATE(0.0, 0.7, -1.2, 2.5, 3.1);
  const Assembled found(R"("gravity": [0, 0, 0], )" +
                        four_bar({.A = R"(, "start": {"position": {"rz": )" + std::to_string(asked) + "}}"}));
  CAPTURE(asked);
  CHECK(std::remainder(found.angle("crank") - asked, kTwoPi) == Approx(0).margin(1e-9));
  const double x = 0.3 * std::cos(asked), y = 0.3 * std::sin(asked);  // of B; then C = D + 0.8 (cos, sin)
  const double dx = x - 1, dy = y, d = std::hypot(dx, dy);
  const double coupler = std::hypot(0.8, 0.4123105625617661), rocker = std::hypot(0.1, 0.7937253933193772);
  const double beside = std::acos((d * d + rocker * rocker - coupler * coupler) / (2 * d * rocker));
  const double one = std::atan2(dy, dx) - beside, other = std::atan2(dy, dx) + beside;
  const double is = found.angle("rocker");
  CAPTURE(is, one, other);
  CHECK(std::min(std::abs(std::remainder(is - one, kTwoPi)), std::abs(std::remainder(is - other, kTwoPi))) < 1e-8);
}

// Turned about x by a, then about the new y by b.
TEST_CASE("a start may ask for both angles of a universal joint", "[unit][assembly]") {
  const auto [a, b] = GENERATE(table<double, double>({{1, 0.5}, {-2.5, 1.2}, {0.3, -3.0}}));
  CAPTURE(a, b);
  const Assembled found(R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "U", "type": "universal", "p": "b", "s": "ground", "at": [0, 0, 0], "start": {"position": )" +
                        fmt::format(R"({{"rx": {}, "ry": {}}}}}}}])", a, b));
  const double qw = std::abs(body_pose(found.m.system.body("b"), found.state).q.w);
  CHECK(std::abs(qw - std::abs(std::cos(a / 2) * std::cos(b / 2))) < 1e-9);
}

// (x - 0)^2 + (x - 0.3)^2 is least at 0.15.
TEST_CASE("a coordinate may be asked for approximately", "[unit][assembly]") {
  const Assembled found(
      R"("bodies": [{"name": "slider", "mass": 2, "inertia": [1, 1, 1]}],
         "links": [{"name": "G", "type": "prismatic", "p": "slider", "s": "ground", "at": [0, 0, 0], "axis": "x",
                    "start": {"near": {"z": "30 cm"}}}])");
  CHECK(found.place("slider")[0] == Approx(0.15).margin(1e-9));
}

// A plate whose point at a along x comes to S on the hinge, a (0.8, 0.5): a turn theta takes its frame to S - a (cos theta,
// sin theta), and turns count as displacements at the length of the mechanism, which is a here. With the weight w of the
// pose and an angle phi asked for beside it, w (|S/a - (cos, sin)|^2 + theta^2) + (theta - phi)^2 is least, in a^2.
TEST_CASE("rotations of a start count as displacements at the length of the mechanism", "[unit][assembly]") {
  const auto [a, w, phi] = GENERATE(table<double, double, double>(
      {{3.0, 1.0, 0.3}, {3.0, 0.5, -0.7}, {1.0, 1.0, 0.3}, {0.02, 1.0, 0.3}, {0.02, 4.0, -0.7}}));
  CAPTURE(a, w, phi);
  const auto number = [](double x) { return fmt::format("{:.17g}", x); };
  const Assembled found(R"("gravity": [0, 0, 0],
    "bodies": [{"name": "plate", "mass": 2, "inertia": )" +
                        fmt::format("[{0}, {0}, {0}]", 0.1 * a * a) + R"(, "start_weight": )" + number(w) + R"(}],
    "links": [{"name": "A", "type": "revolute", "p": "plate", "s": "ground", "at_p": [)" +
                        number(a) + R"(, 0, 0], "at_s": [)" + number(0.8 * a) + ", " + number(0.5 * a) +
                        R"(, 0], "start": {"near": {"rz": )" + number(phi) + "}}}]");
  CHECK(found.m.system.length() == Approx(a));
  double low = -kPi / 2, high = kPi / 2;  // half of the derivative rises between them
  while (high - low > 1e-14) {
    const double theta = 0.5 * (low + high);
    const double slope = w * (0.8 * std::sin(theta) - 0.5 * std::cos(theta) + theta) + (theta - phi);
    (slope < 0 ? low : high) = theta;
  }
  CHECK(found.angle("plate") == Approx(low).margin(1e-7));
  CHECK((found.place("plate") / a - Vec3(0.8 - std::cos(low), 0.5 - std::sin(low), 0)).norm() < 1e-7);
}

// Missed where poses count as much: by half of 0.3 m; met where the slider begins there already.
TEST_CASE("a coordinate that is missed is reported by name", "[unit][assembly]") {
  const auto [at, missed] = GENERATE(table<std::string, bool>({{"[0, 0, 0]", true}, {"[0.2999, 0, 0]", false}}));
  const Assembled found(R"("bodies": [{"name": "slider", "mass": 2, "inertia": [1, 1, 1], "position": )" + at + R"(}],
         "links": [{"name": "G", "type": "prismatic", "p": "slider", "s": "ground", "at_p": )" +
                        at + R"(, "at_s": [0, 0, 0],
                    "axis": "x", "start": {"near": {"z": "30 cm"}}}])");
  CAPTURE(at);
  REQUIRE(found.report.findings.size() == (missed ? 1 : 0));
  if (missed)
    testing::check_words(found.report.findings[0].text(),
                         {"joint 'G'", "z begins at 0.15 m", "instead of near 0.3 m", "\"position\""});
}

// A whole turn off is no miss.
TEST_CASE("an angle that is missed is reported in degrees", "[unit][assembly]") {
  const auto [free, missed] = GENERATE(table<std::string, bool>({{"", true}, {R"(, "assembled": "free")", false}}));
  const Assembled found(R"("bodies": [{"name": "p", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]})" + free +
                        R"(}], "links": [{"name": "A", "type": "revolute", "p": "p", "s": "ground", "at": [0, 0, 0],
                               "start": {"near": {"rz": "420 deg"}}}])");
  CAPTURE(free);
  REQUIRE(found.report.findings.size() == (missed ? 1 : 0));
  if (missed)
    testing::check_words(found.report.findings[0].text(), {"joint 'A'", "rz begins at", "instead of near 420 deg"});
}

TEST_CASE("incompatible targets are rejected by name", "[unit][assembly]") {
  try {
    const Assembled found(R"("gravity": [0, 0, 0], )" + four_bar({.A = R"(, "start": {"position": {"rz": 0}})",
                                                                  .D = R"(, "start": {"position": {"rz": -2}})"}));
    FAIL("it was assembled");
  } catch (const AssemblyError& error) {
    const std::string words = error.what();
    CAPTURE(words);
    CHECK(words.find("A.rz") != std::string::npos);
    CHECK(words.find("D.rz") != std::string::npos);
    CHECK(words.find("approximate") != std::string::npos);
  }
}

TEST_CASE("a weight without a meaning is rejected", "[unit][assembly]") {
  testing::check_words(testing::message_of<SceneError>([&] { Assembled(two_points(R"(, "start_weight": -1)", "")); }),
                       {"start_weight", "must not be below zero"});
  testing::check_words(testing::message_of<SceneError>(
                           [&] { Assembled(two_points(R"(, "start_weight": 2, "assembled": "free")", "")); }),
                       {"start_weight", "\"assembled\" is \"free\"", "remove one of the two"});
}

namespace {

/// C = x of a body: a link that names no pair of markers.
class Unpaired final : public Lock {
 public:
  Unpaired(std::string name, Body& body) : Lock(std::move(name)), body_(body) {}
  std::string_view type() const override { return "unpaired"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {}; }
  RowPlan plan_rows() override {
    RowPlan plan;
    plan.add({RowKind::function, "x"});
    plan.slots.add(body_.slot);
    return plan;
  }
  void gather(Group links, const Inputs& in, RowSpan out) const override {
    for (std::size_t i = 0; i < links.size(); ++i) {
      const RowBlock block = out.lane(i);
      block.C(0) = in.slot(static_cast<const Unpaired&>(*links[i]).body_.slot).x[0];
      block.Ct(0) = 0, block.Qhat(0) = 0;
      block.set(0, 0, Vec3::UnitX(), Vec3::Zero());
    }
  }

 private:
  Body& body_;
};

/// Why a body in a ball joint J, and one in a link X without pairs, are not assembled so; "" where they are.
std::string refusal_of(const AssemblyOptions& options) {
  System system;
  Body& a = system.add_body("a", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  Body& b = system.add_body("b", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  system.add<Spherical>("J", a, system.ground(), Pose{});
  system.add(std::make_unique<Unpaired>("X", b));
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  State state = system.start();
  try {
    assemble(dynamics, state, {}, options);
  } catch (const ModelError& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("targets of a start without a meaning are rejected by name", "[unit][assembly]") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
  CHECK(refusal_of({.coordinates = {{"J", Axis::rz, 0.1}}}).empty());
  CHECK(refusal_of({.coordinates = {{"J", Axis::rz, 0.1, 0.0}}, .poses = {{"a", kInfinite}}}).empty());
  for (const double weight : {-1.0, kNan, -kInfinite}) {
    const std::string target = refusal_of({.coordinates = {{"J", Axis::rz, 0.1, weight}}});
    const std::string pose = refusal_of({.poses = {{"a", weight}}});
    CAPTURE(weight, target, pose);
    CHECK(has(target, "J.rz: the weight"));
    CHECK(has(pose, "'a': the weight"));
  }
  for (const double value : {kInfinite, kNan})
    for (const double weight : {1.0, kInfinite}) {
      const std::string refusal = refusal_of({.coordinates = {{"J", Axis::rz, value, weight}}});
      CAPTURE(value, weight, refusal);
      CHECK(has(refusal, "J.rz: the value"));
    }
  CHECK(has(refusal_of({.coordinates = {{"X", Axis::x, 0}}}), "joint 'X' has no pair of markers"));
}

TEST_CASE("contradictory joints are reported if no exact target exists", "[unit][assembly]") {
  try {
    const Assembled found(R"("bodies": [{"name": "a", "mass": 2, "inertia": [1, 1, 1], "start_weight": 3}],
      "links": [{"name": "J", "type": "spherical", "p": "a", "s": "ground", "at_p": [0, 0, 0], "at_s": [0.3, 0, 0]},
                {"name": "K", "type": "spherical", "p": "a", "s": "ground", "at_p": [0, 0, 0], "at_s": [-0.3, 0, 0]}])");
    FAIL("it was assembled");
  } catch (const AssemblyError& error) {
    const std::string words = error.what();
    CAPTURE(words);
    CHECK(has(words, "constraint errors of up to"));
    CHECK_FALSE(has(words, "asked for"));
  }
}

}  // namespace nearest_start_test
