// SPDX-License-Identifier: BSD-3-Clause
// Starts of more than half a turn: what counts turns begins in the turn that is asked for.
#include <cmath>
#include <string>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/four_bar_scene.h"
#include "tests/support/messages.h"

namespace start_turns_test {

using namespace lockstep;
using lockstep::testing::message_of;

namespace {

constexpr double kDegree = kPi / 180;

std::string scene_of(const std::string& members, const std::string& record, const std::string& formulation = "auto") {
  return R"({"lockstep": 1, "gravity": [0, 0, 0], )" + members +
         R"(, "run": {"until": 1, "output": 0.25, "tolerance": 1e-11, "formulation": ")" + formulation +
         R"(", "record": [)" + record + "]}}";
}

Table history_of(const std::string& text) {
  const Scene scene = scene_from_text(text, "start.json");
  const Registry registry = builtin_registry();
  Table history;
  const SweepRun run = sweep_run(scene, registry, recorded_columns(scene, registry), {}, &history);
  INFO(run.status);
  REQUIRE(run.status == "ok");
  return history;
}

/// A bar on a hinge A about z of the ground, with more keys on the hinge.
std::string bar(const std::string& on_hinge) {
  return R"("bodies": [{"name": "p", "mass": 3, "inertia": [0.25, 0.25, 0.25], "center": [0.5, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "p", "s": "ground", "at": [0, 0, 0], )" +
         on_hinge + "}]";
}
const std::string kSpring = R"(, "forces": [{"name": "T", "type": "torsion_spring_damper", "p": "p", "s": "ground",
    "at": [0, 0, 0], "stiffness": 2}])";

std::string screw(const std::string& more) {
  return R"("bodies": [{"name": "n", "box": {"mass": 1, "size": [0.1, 0.1, 0.1]}}],
    "links": [{"name": "S", "type": "screw", "p": "n", "s": "ground", "at": [0, 0, 0], "lead": 0.1, )" +
         more + "}]";
}

/// Wheels g1 and g2 on hinges A and B, with more keys of these, geared by G; `of_bodies`: more keys of both.
std::string wheels(const std::string& on_A, const std::string& on_B, double ratio, const std::string& of_bodies = "") {
  return R"("bodies": [{"name": "g1", "cylinder": {"mass": 1, "radius": 0.1, "length": 0.02})" + of_bodies + R"(},
    {"name": "g2", "cylinder": {"mass": 2, "radius": 0.2, "length": 0.02}, "position": [0.3, 0, 0])" +
         of_bodies + R"(}],
    "links": [{"name": "A", "type": "revolute", "p": "g1", "s": "ground", "at": [0, 0, 0])" +
         on_A + R"(}, {"name": "B", "type": "revolute", "p": "g2", "s": "ground", "at": [0.3, 0, 0])" + on_B + R"(},
    {"name": "G", "type": "gear", "pairs": ["A", "B"], "ratio": )" +
         std::to_string(ratio) + "}]";
}
std::string driven_from(double angle, double slope = 0) {
  return R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": )" + std::to_string(slope) + R"(, "y0": )" +
         std::to_string(angle) + "}}";
}
/// On one of the wheels.
std::string spring_on(const std::string& wheel, const std::string& at) {
  return R"(, "forces": [{"name": "T", "type": "torsion_spring_damper", "p": ")" + wheel +
         R"(", "s": "ground", "at": )" + at + R"(, "stiffness": 2}])";
}

std::string formulation() { return GENERATE(std::string("omega"), std::string("quaternion"), std::string("joint")); }
// Turns that a law imposes and a closure counts keep a mechanism out of joint coordinates.
std::string formulation_with(const std::string& more) {
  const std::string in = formulation();
  return in == "joint" && more.find("drive") != std::string::npos ? "auto" : in;
}

}  // namespace

// E = 1/2 k theta^2; let go, theta = theta0 cos(w t) with w = sqrt(k/J), J = 3/4 + 1/4 = 1.
TEST_CASE("a torsion spring begins wound by the angle that is asked for", "[unit][assembly]") {
  const std::string in = formulation();
  const double asked = GENERATE(170.0, -180.0, 190.0, 540.0, -725.0);
  CAPTURE(in, asked);
  const Table run =
      history_of(scene_of(bar(R"("start": {"position": {"rz": ")" + std::to_string(asked) + R"( deg"}})") + kSpring,
                          R"("A.rz", "T.angle", "energy.potential")", in));
  const double theta = asked * kDegree;
  CHECK(run.first("A.rz") == Approx(theta));
  CHECK(run.first("T.angle") == Approx(theta));
  CHECK(run.first("energy.potential") == Approx(theta * theta));
  CHECK(run.last("A.rz") == Approx(theta * std::cos(std::sqrt(2.0))));
}

// The bar is given at an angle; the spring counts on from there, whatever half turn its poses are read in.
TEST_CASE("a torsion spring is wound from the pose that a body is given", "[unit][assembly]") {
  const std::string in = formulation();
  const auto [given, asked] = GENERATE(table<double, double>(
      {{170, 190}, {120, 540}, {-170, -190}, {-120, 300}, {180, 540}, {-180, -200}, {170, -170}, {90, 725}}));
  CAPTURE(in, given, asked);
  const Table run = history_of(scene_of(
      R"("bodies": [{"name": "p", "mass": 3, "inertia": [0.25, 0.25, 0.25], "center": [0.5, 0, 0],
                     "orientation": {"axis": "z", "angle": ")" +
          std::to_string(given) + R"( deg"}}],
         "markers": [{"name": "hub", "body": "p", "at": [0, 0, 0]}, {"name": "pin", "body": "ground", "at": [0, 0, 0]}],
         "links": [{"name": "A", "type": "revolute", "p": "hub", "s": "pin",
                    "start": {"position": {"rz": ")" +
          std::to_string(asked) + R"( deg"}}}],
         "forces": [{"name": "T", "type": "torsion_spring_damper", "p": "hub", "s": "pin", "stiffness": 2}])",
      R"("A.rz", "T.angle", "p.center_x")", in));
  const double theta = asked * kDegree;
  CHECK(run.first("A.rz") == Approx(theta));
  CHECK(run.first("T.angle") == Approx(theta));
  CHECK(run.first("p.center_x") == Approx(0.5 * std::cos(theta)).margin(1e-12));
  CHECK(run.last("T.angle") == Approx(theta * std::cos(std::sqrt(2.0))));
}

TEST_CASE("a torsion spring on a driven hinge begins at the angle of the law", "[unit][assembly]") {
  const std::string in = formulation();
  const bool assembled = GENERATE(true, false);
  CAPTURE(in, assembled);
  std::string text =
      scene_of(bar(R"("drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1, "y0": "720 deg"}})") + kSpring,
               R"("A.rz", "energy.potential")", in);
  if (!assembled) text.replace(text.find("\"until\""), 7, R"("assemble": false, "until")");
  if (!assembled) text.replace(text.find(R"("mass")"), 6, R"("omega_world": [0, 0, 1], "mass")");
  const Table run = history_of(text);
  CHECK(run.first("A.rz") == Approx(4 * kPi));
  CHECK(run.last("A.rz") == Approx(4 * kPi + 1));
  CHECK(run.first("energy.potential") == Approx(16 * kPi * kPi));
  CHECK(run.last("energy.potential") == Approx((4 * kPi + 1) * (4 * kPi + 1)));
}

// Two hinges in a row, each at 200 degrees: the tip has turned by 400 against the ground.
TEST_CASE("a coupling that counts several joints begins at their sum", "[unit][assembly]") {
  const std::string in = formulation();
  CAPTURE(in);
  const Table run = history_of(scene_of(
      R"("bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
                    {"name": "c", "rod": {"mass": 1, "from": [1, 0, 0], "to": [2, 0, 0]}}],
         "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0],
                    "start": {"position": {"rz": "200 deg"}},
                    "stops": [{"axis": "rz", "high": "720 deg"}]},
                   {"name": "B", "type": "revolute", "p": "b", "s": "c", "at": [1, 0, 0],
                    "start": {"position": {"rz": "-200 deg"}}}],
         "forces": [{"name": "T", "type": "torsion_spring_damper", "p": "c", "s": "ground", "at": [1, 0, 0],
                     "stiffness": 2}])",
      R"("A.rz", "B.rz", "T.angle", "energy.potential")", in));
  CHECK(run.first("A.rz") == Approx(200 * kDegree));
  CHECK(run.first("B.rz") == Approx(-200 * kDegree));
  CHECK(run.first("T.angle") == Approx(400 * kDegree));
  CHECK(run.first("energy.potential") == Approx(400 * kDegree * 400 * kDegree));
}

// At 1 rad/s the stop, 20 degrees ahead, is met after 0.349 s and sends the bar back.
TEST_CASE("a stop beyond a full revolution is met from the requested revolution", "[unit][assembly]") {
  const std::string in = formulation();
  CAPTURE(in);
  const Table run =
      history_of(scene_of(bar(R"("stops": [{"axis": "rz", "low": "-10 deg", "high": "400 deg", "restitution": 1}],
             "start": {"position": {"rz": "380 deg"}, "velocity": {"rz": 1}})"),
                          R"("A.rz", "A.stop_rz_high.gap")", in));
  CHECK(run.first("A.rz") == Approx(380 * kDegree));
  CHECK(run.first("A.stop_rz_high.gap") == Approx(20 * kDegree));
  CHECK(run.last("A.rz") == Approx(400 * kDegree - (1 - 20 * kDegree)));
}

TEST_CASE("a screw begins at the place of all its revolutions", "[unit][assembly]") {
  const auto [more, turns, rate] = GENERATE(table<std::string, double, double>(
      {{R"("start": {"position": {"rz": "540 deg"}})", 1.5, 0},
       {R"("start": {"position": {"rz": "-900 deg"}})", -2.5, 0},
       {R"("start": {"position": {"z": 0.15}})", 1.5, 0},
       {R"("start": {"position": {"z": "-0.62 m"}})", -6.2, 0},
       {R"("drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1, "y0": "540 deg"}})", 1.5, 1},
       {R"("start": {"position": {"z": 50}})", 500, 0},
       {R"("drive": {"axis": "z", "law": {"type": "ramp", "slope": 0.01, "y0": 0.15}})", 1.5, 0.2 * kPi},
       {R"("drive": {"axis": "z", "law": {"type": "ramp", "slope": 0.01, "y0": -0.62}})", -6.2, 0.2 * kPi},
       {R"("drive": {"axis": "z", "law": {"type": "ramp", "slope": 0.01, "y0": 0.04}})", 0.4, 0.2 * kPi}}));
  const std::string in = formulation_with(more);
  CAPTURE(in, more);
  const Table run = history_of(scene_of(screw(more), R"("S.rz", "n.z")", in));
  CHECK(run.first("S.rz") == Approx(turns * kTwoPi));
  CHECK(run.first("n.z") == Approx(0.1 * turns));
  CHECK(run.last("S.rz") == Approx(turns * kTwoPi + rate));
  CHECK(run.last("n.z") == Approx(0.1 * (turns + rate / kTwoPi)));
}

// theta_A + 2 theta_B = 0.
TEST_CASE("the other wheel of a gear begins in the revolution given by the first", "[unit][assembly]") {
  const std::string start =
      GENERATE(std::string(R"(, "start": {"position": {"rz": "380 deg"}, "velocity": {"rz": 1}})"),
               driven_from(380 * kDegree, 1));
  const std::string in = formulation_with(start);
  CAPTURE(in, start);
  const Table run = history_of(scene_of(wheels(start, "", 2), R"("A.rz", "B.rz", "G.violation")", in));
  CHECK(run.first("A.rz") == Approx(380 * kDegree));
  CHECK(run.first("B.rz") == Approx(-190 * kDegree));
  CHECK(run.first("G.violation") < 1e-10);
  CHECK(run.last("A.rz") == Approx(380 * kDegree + 1));
  CHECK(run.last("B.rz") == Approx(-190 * kDegree - 0.5));
}

// theta_B = -N theta_A, however many turns that is.
TEST_CASE("a wheel with many revolutions for one of the other begins as many revolutions away", "[unit][assembly]") {
  const double teeth = GENERATE(3.0, 10.0, 60.0), asked = GENERATE(360.0, -370.0);
  const double ratio = std::stod(std::to_string(1 / teeth));
  CAPTURE(teeth, asked);
  const Table run =
      history_of(scene_of(wheels(driven_from(asked * kDegree, 0.1), "", ratio) + spring_on("g1", "[0, 0, 0]"),
                          R"("A.rz", "B.rz", "G.violation", "T.angle")"));
  const double theta = asked * kDegree;
  CHECK(run.first("A.rz") == Approx(theta));
  CHECK(run.first("T.angle") == Approx(theta));
  CHECK(run.first("B.rz") == Approx(-theta / ratio));
  CHECK(run.first("G.violation") < 1e-9);
  CHECK(run.last("B.rz") == Approx(-(theta + 0.1) / ratio));
}

TEST_CASE("a start that is not assembled begins in the revolution of its drive, too", "[unit][assembly]") {
  const std::string text =
      scene_of(bar(R"("drive": {"axis": "rz", "law": {"type": "ramp", "slope": 0, "y0": "720 deg"}})") + kSpring, "");
  Mechanism m = build_mechanism(scene_from_text(text, "driven.json"), builtin_registry());
  system_of(m).setup();
  const CountedAngle& angle = *m.system.counted_angles().front();
  const auto begins = [&](const State& s) {
    return angle.expected({s.s.data(), static_cast<std::size_t>(s.s.size())});
  };
  SECTION("simulation") {
    Simulation run(system_of(m), {.assemble = false});
    CHECK(begins(run.state()) == Approx(4 * kPi));
  }
  SECTION("branches") {
    Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
    const BranchReport found = find_branches(dynamics, m.system.start(), {.starts = 3});
    REQUIRE(found.branches.size() == 1);
    CHECK(begins(found.branches.front().state) == Approx(4 * kPi));
  }
}

TEST_CASE("an angle without a number of revolutions is reported, and recorded within half a revolution",
          "[unit][assembly]") {
  const std::string spring = GENERATE(
      "", R"(, "forces": [{"name": "T", "type": "torsion_spring_damper", "p": "p", "s": "ground", "at": [0, 0, 0]}])");
  CAPTURE(spring);
  const std::string text = scene_of(
      R"("bodies": [{"name": "p", "box": {"mass": 3, "size": [0.1, 0.2, 0.3]}}],
         "links": [{"name": "U", "type": "universal", "p": "p", "s": "ground", "at": [0, 0, 0],
                    "start": {"position": {"rx": "540 deg"}}}])" +
          spring,
      R"("U.angle_x")");
  Mechanism m = build_mechanism(scene_from_text(text, "universal.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  State state = m.system.start();
  const AssemblyReport report = assemble(dynamics, state, {}, m.assembly);
  REQUIRE(report.findings.size() == 1);
  testing::check_words(report.findings[0].text(), {"start by U.rx", "540 deg is requested, but counted angles start at", "180 deg"});
  CHECK(std::abs(history_of(text).first("U.angle_x")) == Approx(kPi));
}

// The wheels are driven apart: that is found out in a few iterations, not in as many as the way would take.
TEST_CASE("wheels that contradict each other are rejected at once", "[unit][assembly]") {
  const std::string text = scene_of(wheels(driven_from(40), driven_from(3), 0.1), R"("g1.x")");
  Mechanism m = build_mechanism(scene_from_text(text, "apart.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  State state = m.system.start();
  const std::string said = message_of<AssemblyError>([&] { assemble(dynamics, state); });
  INFO(said);
  const std::string_view before = "stopped after ";
  const auto at = said.find(before);
  REQUIRE(at != std::string::npos);
  CHECK(std::stoi(said.substr(at + before.size())) < 200);
}

// Given at 170 degrees, held at 185 by its tip: what nobody asked to turn begins within half a turn of zero, whatever else
// the scene drives.
TEST_CASE("a spring begins within half a revolution of zero next to a driven joint", "[unit][assembly]") {
  const bool beside = GENERATE(false, true);
  CAPTURE(beside);
  const std::string tip = "[-0.99619469809174555, -0.087155742747658166, 0]";  // at 185 degrees
  const Table run = history_of(scene_of(
      R"("bodies": [{"name": "p", "mass": 3, "inertia": [0.25, 0.25, 0.25], "center": [0.5, 0, 0],
                     "orientation": {"axis": "z", "angle": "170 deg"}},
                    {"name": "q", "rod": {"mass": 1, "from": [3, 0, 0], "to": [4, 0, 0]}}],
         "markers": [{"name": "hub", "body": "p", "at": [0, 0, 0]}, {"name": "pin", "body": "ground", "at": [0, 0, 0]},
                     {"name": "tip", "body": "p", "at": [1, 0, 0]}, {"name": "peg", "body": "ground", "at": )" +
          tip + R"(}],
         "links": [{"name": "A", "type": "revolute", "p": "hub", "s": "pin"},
                   {"name": "B", "type": "spherical", "p": "tip", "s": "peg"},
                   {"name": "D", "type": "revolute", "p": "q", "s": "ground", "at": [3, 0, 0])" +
          (beside ? R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}},
                     "stops": [{"axis": "rz", "high": "400 deg"}])"
                  : "") +
          R"(}],
         "forces": [{"name": "T", "type": "torsion_spring_damper", "p": "hub", "s": "pin", "stiffness": 2}])",
      R"("T.angle", "energy.potential")"));
  CHECK(run.first("T.angle") == Approx(-175 * kDegree));
}

// Bodies that may go anywhere come as near as is asked for, with all that is coupled to them.
TEST_CASE("coupled joints follow if a start is requested approximately", "[unit][assembly]") {
  const double asked = GENERATE(3.0, 7.0, -7.0, 12.6, 20.0, -33.3);
  const bool free = GENERATE(true, false);
  CAPTURE(asked, free);
  const std::string start = R"(, "start": {"near": {"rz": )" + std::to_string(asked) + "}}";
  const Table run =
      history_of(scene_of(wheels(start, "", 1, free ? R"(, "assembled": "free")" : "") + spring_on("g2", "[0.3, 0, 0]"),
                          R"("A.rz", "B.rz", "T.angle", "G.violation")"));
  CHECK(run.first("B.rz") == Approx(-run.first("A.rz")));
  CHECK(run.first("T.angle") == Approx(run.first("B.rz")));
  CHECK(run.first("G.violation") < 1e-9);
  if (free) CHECK(run.first("A.rz") == Approx(asked));
}

// A crank turned by a full turn more stands where it stood, and winds its spring by a turn more.
TEST_CASE("a crank of a loop begins in its revolution, with the rest of the loop unchanged", "[unit][assembly]") {
  const auto begun_at = [](const std::string& angle) {
    return history_of(
        scene_of(testing::four_bar({.A = R"(, "start": {"position": {"rz": ")" + angle + R"("}})"}) +
                     R"(, "forces": [{"name": "T", "type": "torsion_spring_damper", "p": "crank", "s": "ground",
                          "at": [0, 0, 0], "stiffness": 2}])",
                 R"("A.rz", "T.angle", "energy.potential", "rocker.center_x", "coupler.center_y")"));
  };
  const Table near = begun_at("20 deg"), on = begun_at("380 deg");
  CHECK(near.first("A.rz") == Approx(20 * kDegree));
  CHECK(on.first("A.rz") == Approx(380 * kDegree));
  CHECK(on.first("T.angle") == Approx(380 * kDegree));
  CHECK(on.first("energy.potential") == Approx(380 * kDegree * 380 * kDegree));
  CHECK(on.first("rocker.center_x") == Approx(near.first("rocker.center_x")));
  CHECK(on.first("coupler.center_y") == Approx(near.first("coupler.center_y")));
}

// At 180 degrees from the poses given the residual of a drive has no gradient.
TEST_CASE("a drive may begin half a revolution from the given poses of bodies", "[unit][assembly]") {
  const std::string in = formulation();
  const double asked = GENERATE(180.0, -180.0, 540.0, 900.0);
  CAPTURE(in, asked);
  const Table run = history_of(scene_of(
      R"("bodies": [{"name": "b", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
                    {"name": "c", "rod": {"mass": 1, "from": [1, 0, 0], "to": [2, 0, 0]}}],
         "links": [{"name": "A", "type": "revolute", "p": "b", "s": "ground", "at": [0, 0, 0],
                    "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1, "y0": ")" +
          std::to_string(asked) + R"( deg"}}},
                   {"name": "B", "type": "revolute", "p": "c", "s": "b", "at": [1, 0, 0]}])",
      R"("A.rz", "b.center_x", "b.center_y", "B.violation")", in));
  const double theta = asked * kDegree;
  CHECK(run.first("A.rz") == Approx(theta));
  CHECK(run.last("A.rz") == Approx(theta + 1));
  CHECK(run.first("b.center_x") == Approx(-0.5));
  CHECK(run.last("b.center_x") == Approx(-0.5 * std::cos(1.0)));
  CHECK(run.last("b.center_y") == Approx(-0.5 * std::sin(1.0)));
  CHECK(run.last("B.violation") < 1e-9);
}

// The driven bar cannot be where its law begins: its end is held elsewhere.
TEST_CASE("a drive that cannot begin where its law does is named", "[unit][assembly]") {
  const std::string text = scene_of(
      bar(R"("drive": {"axis": "rz", "law": {"type": "ramp", "slope": 0, "y0": "180 deg"}}}, {"name": "B", "type":
             "spherical", "p": "p", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 1, 0])"),
      R"("p.x")");
  Mechanism m = build_mechanism(scene_from_text(text, "held.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  State state = m.system.start();
  const std::string error = message_of<AssemblyError>([&] { assemble(dynamics, state); });
  CAPTURE(error);
  CHECK(testing::says(error, {"drive A.rz begins at 180 deg, 180 deg from the given poses"}));
}

// The hinges of a parallelogram turn along with its crank, which begins a turn away: D's angle is that of A.
TEST_CASE("angles of the far hinges of a double crank begin in the revolution of its drive", "[unit][assembly]") {
  const double turns = GENERATE(1.0, -1.0, 3.0);
  CAPTURE(turns);
  System s;
  const Vec3 D(2, 0, 0), B(std::cos(0.3), std::sin(0.3), 0), C = B + D;
  Body& crank = s.add_body("crank", shapes::rod(1.0, Vec3::Zero(), B));
  Body& coupler = s.add_body("coupler", shapes::rod(1.0, B, C));
  Body& rocker = s.add_body("rocker", shapes::rod(1.0, D, C));
  const double begins = 0.3 + turns * kTwoPi;
  s.add<Revolute>("A", crank, s.ground(), pose_at(Vec3::Zero())).drive(Axis::rz, laws::ramp(0.1, 0, begins));
  s.add<Revolute>("B", coupler, crank, pose_at(B));
  s.add<Revolute>("C", coupler, rocker, pose_at(C));
  s.add<Revolute>("D", rocker, s.ground(), pose_at(D));
  Simulation run(s, {});
  run.record({"D.rz"});
  run.run_until(0.01);
  CHECK(std::abs(run.table().first("D.rz") - begins) < 1e-9);
}

namespace {

/// A four-bar linkage from D = (ground, 0): crank, coupler and rocker of these lengths, given with the crank at 0.5 rad.
std::string linkage(double ground, double crank, double coupler, double rocker, const std::string& on_A) {
  const Vec3 B(crank * std::cos(0.5), crank * std::sin(0.5), 0), D(ground, 0, 0);
  const double d = (B - D).norm();
  const double beside = std::acos((rocker * rocker + d * d - coupler * coupler) / (2 * rocker * d));
  const double angle = std::atan2(B[1] - D[1], B[0] - D[0]) - beside;
  const auto at = [](const Vec3& x) { return fmt::format("[{:.17g}, {:.17g}, 0]", x[0], x[1]); };
  const std::string b = at(B), c = at(D + rocker * Vec3(std::cos(angle), std::sin(angle), 0));
  const auto rod = [](const std::string& name, const std::string& from, const std::string& to) {
    return R"({"name": ")" + name + R"(", "rod": {"mass": 1, "from": )" + from + R"(, "to": )" + to + "}}";
  };
  const auto hinge = [](const std::string& name, const std::string& p, const std::string& s, const std::string& place) {
    return R"({"name": ")" + name + R"(", "type": "revolute", "p": ")" + p + R"(", "s": ")" + s + R"(", "at": )" +
           place;
  };
  return R"("bodies": [)" + rod("crank", "[0, 0, 0]", b) + ", " + rod("coupler", b, c) + ", " +
         rod("rocker", at(D), c) + R"(], "links": [)" + hinge("A", "crank", "ground", "[0, 0, 0]") + on_A + "}, " +
         hinge("B", "coupler", "crank", b) + "}, " + hinge("C", "rocker", "coupler", c) + "}, " +
         hinge("D", "rocker", "ground", at(D)) + "}]";
}

}  // namespace

// theta_A + theta_B + theta_C = theta_D with all turns. The far end of a crank and rocker swings, of a drag link turns along.
// What is recorded changes no position.
TEST_CASE("every hinge of a loop begins in the revolution to which its crank is driven", "[unit][assembly]") {
  const bool turns = GENERATE(false, true), driven = GENERATE(false, true);
  const double asked = GENERATE(4.0, -7.0, 18.0);
  CAPTURE(turns, driven, asked);
  const std::string on_A =
      driven ? driven_from(asked) : R"(, "start": {"position": {"rz": )" + std::to_string(asked) + "}}";
  const std::string members = turns ? linkage(0.3, 0.8, 0.7, 0.9, on_A) : linkage(1, 0.3, 0.9, 0.8, on_A);
  const Table run =
      history_of(scene_of(members, R"("rocker.center_x", "A.rz", "B.rz", "C.rz", "D.rz")"));
  const double A = run.first("A.rz"), D = run.first("D.rz");
  CHECK(A == Approx(asked));
  CHECK(A + run.first("B.rz") + run.first("C.rz") == Approx(D).margin(1e-9));
  CHECK(std::abs(turns ? D - A : D) < kPi);
  CHECK(history_of(scene_of(members, R"("rocker.center_x")")).first("rocker.center_x") == run.first("rocker.center_x"));
}

}  // namespace start_turns_test
