// SPDX-License-Identifier: BSD-3-Clause
// The commonest mistakes of a model, and the facts by which `check` and `run` report them.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace mistakes_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

/// A line of the program's, with its exit code and the facts of the error.
struct Mistake {
  std::string line;
  int code;
  std::vector<std::string> facts;
};

// A four-bar in its zero position, all bars along x but the rocker: it is assembled by lengths alone. `of_crank`: more
// of joint A.
std::string four_bar(const std::string& rocker, const std::string& of_crank = "") {
  return scene_file("lengths", R"("parameters": {"rocker": ")" + rocker + R"("}, "bodies": [
    {"name": "crank", "rod": {"mass": 1, "from": [0,0,0], "to": [0.1,0,0]}},
    {"name": "coupler", "rod": {"mass": 1, "from": [0.1,0,0], "to": [0.4,0,0]}},
    {"name": "rocker", "rod": {"mass": 1, "from": [0.28,0,0], "to": [0.28,"=rocker",0]}}], "links": [
    {"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0,0,0])" +
                                   of_crank + R"(},
    {"name": "B", "type": "revolute", "p": "coupler", "s": "crank", "at": [0.1,0,0]},
    {"name": "C", "type": "revolute", "p": "coupler", "s": "rocker", "at_p": [0.4,0,0], "at_s": [0.28,"=rocker",0]},
    {"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at_p": [0.28,0,0], "at_s": [0.28,0,0]}],
    "run": {"until": 0.1, "record": ["rocker.angle_z"]})");
}

// A crank of 0.15 m and a rod of 0.35 m along x; the guide of their slider is `offset` m beside A.
std::string slider_crank(const std::string& offset, const std::string& of_crank = "") {
  return scene_file("offset", R"("bodies": [
    {"name": "crank", "rod": {"mass": 1, "from": [0,0,0], "to": [0.15,0,0]}},
    {"name": "rod", "rod": {"mass": 2, "from": [0.15,0,0], "to": [0.5,0,0]}},
    {"name": "slider", "mass": 3, "inertia": [0.01, 0.01, 0.01], "position": [0.5,0,0]}], "joints": [
    {"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0,0,0])" +
                                  of_crank + R"(},
    {"name": "B", "type": "revolute", "p": "rod", "s": "crank", "at": [0.15,0,0]},
    {"name": "C", "type": "revolute", "p": "slider", "s": "rod", "at": [0.5,0,0]},
    {"name": "guide", "type": "prismatic", "p": "slider", "s": "ground", "at_p": [0.5,0,0], "axis": "x",
     "at_s": [0.5,)" + offset + R"(,0]}], "run": {"until": 0.1, "record": ["slider.x"]})");
}

// A shaft in two hinges, each driven.
std::string two_motors(const std::string& second) {
  return scene_file("two_motors",
                    R"("bodies": [{"name": "shaft", "cylinder": {"mass": 2, "radius": 0.02, "length": 0.5}}],
    "links": [{"name": "A", "type": "revolute", "p": "shaft", "s": "ground", "at": [0, 0, -0.25],
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "60 rpm"}}},
              {"name": "B", "type": "revolute", "p": "shaft", "s": "ground", "at": [0, 0, 0.25],
               "drive": {"axis": "rz", "law": {"type": "ramp", "slope": ")" +
                        second + R"("}}}],
    "run": {"until": 0.1, "record": ["shaft.omega_world_z"]})");
}

// A parallelogram in line with its base; `of_crank`: more of joint A.
std::string flat_parallelogram(const std::string& of_crank) {
  return scene_file("flat", R"("gravity": [0, -9.81, 0], "bodies": [
    {"name": "a", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}},
    {"name": "b", "rod": {"mass": 1, "from": [1,0,0], "to": [3,0,0]}},
    {"name": "c", "rod": {"mass": 1, "from": [2,0,0], "to": [3,0,0]}}], "joints": [
    {"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0,0,0])" +
                                of_crank + R"(},
    {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [1,0,0]},
    {"name": "C", "type": "revolute", "p": "c", "s": "b", "at": [3,0,0]},
    {"name": "D", "type": "revolute", "p": "c", "s": "ground", "at": [2,0,0]}],
    "run": {"until": 0.5, "output": 0.1, "record": ["A.rz"]})");
}

// Two rods of 0.5 m from the horizontal, at rest.
std::string two_rods() {
  return scene_file("two_rods", R"("gravity": [0, -9.81, 0], "bodies": [
    {"name": "a", "rod": {"mass": 1, "from": [0,0,0], "to": [0.5,0,0]}},
    {"name": "b", "rod": {"mass": 1, "from": [0.5,0,0], "to": [1,0,0]}}], "joints": [
    {"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0,0,0]},
    {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [0.5,0,0]}],
    "run": {"until": 5, "output": 0.1, "record": ["A.rz", "B.rz"]})");
}

void check_mistake(const Mistake& m) {
  const Called called = call(m.line);
  INFO(m.line << "\n" << called.text);
  CHECK(called.exit == m.code);
  for (const std::string& fact : m.facts) {
    INFO(fact);
    CHECK(contains(called.text, fact));
  }
}

}  // namespace

TEST_CASE("a loop that cannot close is reported by the lengths of its bodies", "[runner]") {
  // The rocker is 1 m, the others reach 0.28 + 0.1 + 0.3 = 0.68 m.
  const std::string line = four_bar("1 m");
  for (const char* command : {"check '", "run '", "assemble '", "kinematics '"})
    check_mistake({command + line + "'",
                   5,
                   {"error: the mechanism cannot be assembled: a loop is open by 0.32 m", "rocker spans 1 m",
                    "reach 0.68 m together", "hint: make rocker at least 0.32 m shorter"}});
  check_mistake(
      {"check '" + four_bar("250 m") + "'", 5, {"rocker spans 250 m", "check the unit of a length of rocker"}});
  check_mistake({"check '" + four_bar("250 mm") + "'", 0, {"OK: the mechanism assembles"}});
  check_mistake({"check '" + four_bar("250 mm") + "' --set links.D.at_s.0=280",
                 5,
                 {"ground spans 280 m", "hint: check the unit of the places of joints"}});
  check_mistake({"check " + sample("slider_crank") + " --set joints.guide.axis=z",
                 6,
                 {"hint: joint guide slides along the normal of the plane in which joints A, B and C move",
                  "such as \"axis\": \"x\""}});
  check_mistake({"check " + sample("slider_crank") + " --set joints.guide.axis=z --set joints.guide.type=cylindrical",
                 6,
                 {"hint: joint guide slides along the normal of the plane in which joints A, B and C move"}});
  check_mistake(
      {"check " + sample("four_bar") + " --set joints.A.drive.axis=z --set 'joints.A.drive.law.slope=450 rpm'",
       3,
       {"joint 'A': drive on z: the joint holds this coordinate; drive a free one (rz)"}});
  check_mistake(
      {"check " + sample("four_bar") + " --set coupler=30",  // m
       3,
       {"acos of", "coupler = 30 m, rocker = 0.25 m", "their units", "with coupler=30 (300 mm in the file)"}});
}

TEST_CASE("a loop that cannot close where its drive begins is reported with the drive", "[runner]") {
  // The crank of 0.1 m begins 60 deg off the base of 0.28 m, with its end sqrt(0.1^2 + 0.28^2 - 0.1 0.28) = 0.2458 m
  // from D: a rocker of 0.56 m is 0.0142 m too long for that and the coupler of 0.3 m.
  const std::string begins = R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1, "y0": "60 deg"}})";
  check_mistake({"check '" + four_bar("560 mm", begins) + "'",
                 5,
                 {"with drive A at its start, a loop is open by 0.0142 m", "rocker spans 0.56 m from joint",
                  "reach 0.546 m together", "or let drive A begin elsewhere"}});
  check_mistake({"check '" + four_bar("1 m", begins) + "'", 5, {"error: the mechanism cannot be assembled: a loop"}});
}

TEST_CASE("a guide out of reach is reported by its least distance", "[runner]") {
  check_mistake({"check '" + slider_crank("0.3") + "'", 0, {"OK: the mechanism assembles"}});
  check_mistake(
      {"check '" + slider_crank("0.8") + "'",
       5,
       {"error: the mechanism cannot be assembled: a loop is open by 0.3 m", "together span at least 0.8 m from joint",
        "reach 0.5 m together", "at least 0.3 m nearer to each other"}});
  const std::string at_zero = R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}})";
  check_mistake({"check '" + slider_crank("0.4", at_zero) + "'",  // the rod of 0.35 m from B
                 5,
                 {"with drive A at its start, a loop is open by 0.05 m", "but rod reaches 0.35 m\n"}});
}

TEST_CASE("drives that contradict are reported with their speeds", "[runner]") {
  for (const char* command : {"check '", "run '"})
    check_mistake({command + two_motors("61 rpm") + "'",
                   5,
                   {"error: drives A.rz and B.rz contradict",
                    "at t = 0 s: B.rz prescribes 6.388 rad/s, but 6.283 rad/s is required of it by A.rz",
                    "hint: remove one of them"}});
  check_mistake({"check '" + two_motors("60 rpm") + "'", 0, {"OK: "}});
}

// A crank of 18 mm in place of 15 mm: at 171 degrees the legs are drawn straight.
TEST_CASE("a mechanism that locks names its crank and the loop that cannot follow", "[runner]") {
  const Called ran = run_named(defect("locks_jansen"), "locks_jansen");
  INFO(ran.text);
  CHECK(ran.exit == 6);
  CHECK(contains(ran.text, "saved: 12 rows in "));
  CHECK_FALSE(contains(ran.text, "two laws may drive one coordinate"));
  CHECK(contains(ran.text,
                 "error: drive A.rz has reached a limit position (dead centre) at t = 0.5988 s: the loop of "
                 "joints A, M1, M2, U, D, E, D2, F, B1 and B2 allows no further motion"));
}

TEST_CASE("a drive into a dead centre is reported with its joints and its time", "[runner]") {
  // Crank 0.15 m, rod 0.12 m: the rod stands normal to the guide when sin(angle) = 0.8.
  const Called run = call("run " + sample("slider_crank") + " --set 'rod=120 mm' --no-picture --record dead.csv");
  INFO(run.text);
  CHECK(run.exit == 6);
  CHECK(contains(run.text,
                 "error: drive A.rz has reached a limit position (dead centre) at t = 0.1476 s"));  // asin(0.8)/2 pi
  CHECK(contains(run.text, "saved: 15 rows"));
  check_mistake({"kinematics " + sample("slider_crank") + " --set 'rod=120 mm' --record dead.csv",
                 6,
                 {"error: drive A.rz has reached a limit position (dead centre) at t = 0.1476 s",
                  "hint: change the lengths or the axis of guide, or end the motion before it", "saved: 15 rows in"}});
  // Equal reasons of a sweep are one, and a status is one line.
  check_mistake({"sweep " + sample("slider_crank") + " --vary 'rod=110mm:130mm:3' --vary crank=150mm --record dead.csv",
                 1,
                 {"error: 3 runs (rod = 110 ... 130 mm, crank = 150 mm) failed, the first by: drive A.rz has reached a "
                  "limit position"}});
  std::ifstream table(kRunnerFolder + "/dead.csv");
  const std::string rows{std::istreambuf_iterator<char>(table), {}};
  CHECK(std::ranges::count(rows, '\n') == 4);
  CHECK(contains(rows, "failed: drive A.rz has reached a limit position (dead centre)"));
}

TEST_CASE("a drive into a stop is reported, also into one that bounces and into that of another joint", "[runner]") {
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(kFourBar));
  for (const auto& [joint, stop] : {std::pair<int, nlohmann::json>{0, {{"high", "30 deg"}, {"restitution", 0.5}}},
                                    std::pair<int, nlohmann::json>{3, {{"low", "-5 deg"}, {"high", "5 deg"}}}}) {
    nlohmann::json stopped = scene;
    stopped["joints"][joint]["stops"] = nlohmann::json::array({stop});
    stopped["joints"][joint]["stops"][0]["axis"] = "rz";
    std::ofstream(kRunnerFolder + "/stopped.json") << stopped;
    check_mistake({"run stopped.json --no-picture",
                   5,
                   {"error: drive A.rz runs into stop ", joint == 0 ? "A.stop_rz_high at t = " : "D.stop_rz_",
                    "hint: end the motion before the stop"}});
  }
}

TEST_CASE("a locked mechanism that is driven is reported, with the axis that locks it", "[runner]") {
  for (const char* command : {"check ", "run "})
    check_mistake(
        {command + sample("slider_crank") + " --set links.B.type=fixed",
         5,
         {"error: the mechanism is locked: its joints leave no degree of freedom, so drive A.rz cannot move it"}});
  nlohmann::json turned = nlohmann::json::parse(std::ifstream(kFourBar));
  turned["joints"][2]["axis"] = "x", turned["planar"] = "off";
  std::ofstream(kRunnerFolder + "/turned.json") << turned;
  check_mistake({"check turned.json",
                 5,
                 {"the mechanism is locked", "correct the axis of joint C: it is 90 deg off the axes of all other joints"}});
  for (const double tilt : {1e-7, 1e-5, 1e-3}) {
    CAPTURE(tilt);
    turned["joints"][2]["axis"] = {tilt, 0, 1};
    std::ofstream(kRunnerFolder + "/turned.json") << turned;
    check_mistake({"check turned.json --nearly-redundant held",
                   5,
                   {"the mechanism is locked", "correct the axis of joint C: it is"}});
    const Called released = call("run turned.json --no-picture --record released.csv");
    const Called plane = call("run " + sample("four_bar") + " --no-picture --record plane.csv");
    INFO(released.text);
    REQUIRE(released.exit == 0);
    CHECK(contains(released.text, "It is released. Left out, with the redundant ones: D"));
    for (const char* column : {"rocker", "drive_torque"})
      CHECK(std::abs(table_of("released").last(column) - table_of("plane").last(column)) < 10 * tilt + 1e-7);
    for (const char* command : {"assemble turned.json", "kinematics turned.json --record driven.csv"}) {
      const Called called = call(command);
      INFO(called.text);
      CHECK(called.exit == 0);
      CHECK(contains(called.text, "correct the axis of joint C: it is "));
    }
    CHECK(std::abs(table_of("driven").last("rocker") - table_of("plane").last("rocker")) < 10 * tilt + 1e-7);
  }
}

TEST_CASE("a start outside a stop and a step that is too long are reported as such", "[runner]") {
  for (const char* command : {"check ", "run ", "assemble "})
    check_mistake({command + sample("bouncing_pendulum") + " --set 'links.hinge.stops.0.low=100 deg'",
                   5,
                   {"beyond the stop 'hinge.stop_rz_low': the coordinate is ",
                    " deg, its limit is 100 deg\n  hint: widen its range"}});
  check_mistake({"run " + sample("mass_spring_damper") + " --integrator rk4 --step 0.05",
                 7,
                 {"error: the step of 0.05 s is too long: at t = 0 s the fastest motion has a rate of 2e+03",
                  "hint: take a step of 5e-05 to 0.0005 s"}});
  const std::string mount = scene_file("mount", R"("gravity": [0, -9.81, 0], "bodies": [
    {"name": "block", "box": {"mass": 0.2, "size": [0.05, 0.05, 0.05]}},
    {"name": "rod", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "joints": [{"name": "hinge", "type": "revolute", "p": "rod", "s": "block", "at": [0,0,0]}],
    "forces": [{"name": "rubber", "type": "bushing", "p": "block", "s": "ground", "at": [0,0,0],
                "stiffness": [5e5, 5e5, 5e5], "torsion_stiffness": [500, 500, 500],
                "damping": [2e3, 2e3, 2e3], "torsion_damping": [2, 2, 2]}],
    "run": {"until": 0.5, "record": ["rod.x"]})");
  check_mistake({"run '" + mount + "' --integrator rk4 --step 1e-3 --no-picture",  // not the rate of the last state
                 7,
                 {"the fastest motion has a rate of 2.37e+04 1/s", "take a step of 4.2e-06 to 4.2e-05 s"}});
}

TEST_CASE("a step that is too long is judged by the motion, not by the state that it left", "[runner]") {
  const std::string line = "run '" + two_rods() + "' --no-picture --record rods.csv --integrator ";
  for (const char* method : {"dopri5:fixed=true --step 0.5", "dop853:fixed=true --step 0.2"}) {
    const Called ran = call(line + method);
    INFO(ran.text);
    CHECK(ran.exit == 7);
    CHECK(contains(ran.text, "the fastest motion has a rate of 30."));  // 1e6 1/s at the last speed
    CHECK(contains(ran.text, "hint: take a step of 0.0033 to 0.033 s"));
    CHECK_FALSE(contains(ran.text, "its function"));
    CHECK(contains(ran.text, "such as dopri5 (--integrator dopri5)"));
  }
  CHECK(call(line + "dopri5:fixed=true --step 0.02").exit == 0);
  const Called cut = call(line + "rattle2 --step 0.5");
  INFO(cut.text);
  CHECK(cut.exit != 0);
  CHECK(contains(cut.text, "the step of 0.1 s is too long"));  // outputs cut it
  CHECK_FALSE(contains(cut.text, "check its laws"));
  const Called newton = call(line + "radau5:fixed=true --step 0.05");
  INFO(newton.text);
  CHECK(contains(newton.text, "hint: take a smaller step (--step), or let the method choose it"));
  CHECK_FALSE(contains(newton.text, "changes most"));
  check_mistake({line + "semi_implicit_euler --step 0.2",
                 7,
                 {"the kinetic energy is inf", "hint: take a step of 0.0033 to 0.033 s"}});
  // A spring that is soft where the motion begins: k q^2 is its stiffness, and sqrt(3 k/m) q the rate.
  check_mistake({"run '" + scene_file("hardening", R"("gravity": [0,0,0], "bodies": [
      {"name": "m", "sphere": {"mass": 1, "radius": 0.1}, "velocity": [0,0,10]}],
    "joints": [{"name": "slide", "type": "prismatic", "p": "m", "s": "ground", "at": [0,0,0]}],
    "forces": [{"name": "k", "type": "function_force", "p": "m", "s": "ground", "at": [0,0,0], "coordinate": "z",
                "force": "=-1e6*q^3 - 0.5*qd"}],
    "run": {"until": 5, "output": 0.1, "record": ["m.z"]})") +
                     "' --no-picture --integrator rk4 --step 0.05",
                 7,
                 {"error: the step of 0.05 s is too long: at t = 0.1", "the fastest motion has a rate of 20"}});
}

TEST_CASE("a dead centre is reported by every method, and drives that begin apart by their positions", "[runner]") {
  const auto driven = [](const std::string& name, const std::string& law) {
    return "run '" +
           scene_file(name, R"("bodies": [{"name": "u", "rod": {"mass": 1, "from": [0,0,0], "to": [0.5,0,0]}},
      {"name": "v", "rod": {"mass": 1, "from": [0.5,0,0], "to": [0.5,0.5,0]}},
      {"name": "s", "box": {"mass": 1, "size": [0.1,0.1,0.1]}, "position": [0.5,0.5,0]}],
    "joints": [{"name": "A", "type": "revolute", "p": "u", "s": "ground", "at": [0,0,0]},
               {"name": "B", "type": "revolute", "p": "v", "s": "u", "at": [0.5,0,0]},
               {"name": "C", "type": "revolute", "p": "v", "s": "s", "at": [0.5,0.5,0]},
               {"name": "G", "type": "prismatic", "p": "s", "s": "ground", "at": [0.5,0.5,0], "axis": "x",
                "drive": {"axis": "z", "law": )" +
                                law + R"(}}],
    "run": {"until": 1, "output": 0.01, "record": ["s.x"]})") +
           "' --no-picture";
  };
  // Both rods of 0.5 m are in line where 0.5 + t = sqrt(1 - 0.25).
  for (const char* method : {"dopri5", "rk4 --step 1e-3", "rattle4 --step 1e-3", "generalized_alpha --step 1e-3"})
    check_mistake({driven("in_line", R"({"type": "ramp", "slope": 1})") + " --integrator " + method,
                   6,
                   {"error: drive G.z has reached a limit position (dead centre) at t = 0.366 s"}});
  check_mistake({driven("far", R"({"type": "formula", "y": "=3 + t"})"),
                 5,
                 {"with drive G at its start, a loop is open by 2.54 m", "or let drive G begin elsewhere"}});
  check_mistake(
      {"run '" + scene_file("apart", R"("bodies": [
      {"name": "shaft", "cylinder": {"mass": 2, "radius": 0.02, "length": 0.5}}],
    "joints": [{"name": "A", "type": "revolute", "p": "shaft", "s": "ground", "at": [0,0,-0.25],
                "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}}},
               {"name": "B", "type": "revolute", "p": "shaft", "s": "ground", "at": [0,0,0.25],
                "drive": {"axis": "rz", "law": {"type": "formula", "y": "=t + 0.1"}}}],
    "run": {"until": 1, "record": ["A.rz"]})") +
           "'",
       5,
       {"error: drives A.rz and B.rz contradict at t = 0 s: the positions that they prescribe do not agree, 0 "
        "rad and 0.1 rad"}});
}

TEST_CASE("a run from a singular start is reported as undetermined, not as locked", "[runner]") {
  const std::string drive = R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "60 rpm"}})";
  const std::string fact =
      "error: the configuration at t = 0 s is singular: the direction in which the loop of joints A, ";
  const auto run = [](const std::string& scene) { return "run '" + scene + "' --no-picture --record flat.csv"; };
  check_mistake({run(flat_parallelogram(drive)), 6, {fact, "hint: start near it, on the intended side, or change"}});
  const std::string turns = R"(, "start": {"velocity": {"rz": 1}})";
  check_mistake(
      {run(flat_parallelogram(turns)), 6, {fact, "give every joint of the loop a velocity along one branch"}});
  const Called at_rest = call(run(flat_parallelogram("")));
  INFO(at_rest.text);
  CHECK(contains(at_rest.text, "hint: start slightly off it"));
  CHECK_FALSE(contains(at_rest.text, "dense"));
}

TEST_CASE("a run that stops because its constraints drifted is not reported as a dead centre", "[runner]") {
  check_mistake({"run " + sample("four_bar") +
                     " --stabilization none --tolerance 1e-3 --until 100 --no-picture --record drifted.csv",
                 6,
                 {"error: the constraints drift", "hint: project after each step"}});
}

TEST_CASE("an error of a scene names the bare numbers of the command line", "[runner]") {
  check_mistake({"check " + sample("slider_crank") + " --set bodies.crank.rod.mass=-1",
                 3,
                 {"slider_crank.json:", "  with bodies.crank.rod.mass=-1 from the command line, in SI units"}});
  const std::string lever =
      scene_file("lever", R"~("parameters": {"length": "100 mm", "height": "=sqrt((1 m)^2 - length^2)"
},
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": ["=length", "=height", 0]}}],
    "run": {"until": 1})~");
  for (const char* words : {" --set length=60", " --vary length=60:70:2"})
    check_mistake({(std::string(words).find("vary") == std::string::npos ? "run '" : "sweep '") + lever + "'" + words,
                   3,
                   {"sqrt of ", " (100 mm in the file) from the command line, in SI units"}});
}

TEST_CASE("a law that ends is reported first, and the short steps behind it", "[runner]") {
  const std::string ends = scene_file("ends", kArm + "\"joints\": [{" + kHinge + R"~(, "drive": {"axis": "rz",
    "law": {"type": "formula", "y": "=sqrt(0.5 - t)"}}}], "run": {"until": 1})~");
  const Called run = call("run '" + ends + "' --no-picture --record ends.csv");
  INFO(run.text);
  CHECK(run.exit == 7);
  CHECK(contains(run.text, "error: t = 0.5"));
  CHECK(contains(run.text, "joint 'A' (revolute) computed a number that is not finite: the law of drive rz"));
  CHECK(contains(run.text, "(dopri5: the step shrank to "));
}

TEST_CASE("words of other programs are understood as hints", "[runner]") {
  for (const auto& [theirs, ours] : std::vector<std::pair<std::string, std::string>>{{"hinge", "revolute"},
                                                                                     {"pin", "revolute"},
                                                                                     {"ball", "spherical"},
                                                                                     {"weld", "fixed"},
                                                                                     {"slider", "prismatic"},
                                                                                     {"cardan", "universal"},
                                                                                     {"hooke", "universal"},
                                                                                     {"planar", "plane_on_plane"},
                                                                                     {"rigid", "fixed"}})
    check_mistake({"check " + sample("four_bar") + " --set links.C.type=" + theirs,
                   3,
                   {"unknown type \"" + theirs + "\"; did you mean \"" + ours + "\"?"}});
  check_mistake({"run " + sample("four_bar") + " --integrator rk45", 2, {"did you mean \"dopri5\"?"}});
}

TEST_CASE("a scene may use joints for links, or both", "[runner]") {
  const auto scene = [](const std::string& first, const std::string& second) {
    return scene_file("joints", kArm + "\"" + first + R"(": [{)" + kHinge + R"(}], ")" + second +
                                    R"(": [{"name": "B", "type": "distance", "p": "arm", "s": "ground", "at_p": [1,0,0],
       "at_s": [2,0,0], "length": 1}], "run": {"until": 0.1})");
  };
  for (const auto& [first, second] : {std::pair{"links", "joints"}, {"joints", "links"}}) {
    const Called both = call("check '" + scene(first, second) + "'");
    INFO(both.text);
    CHECK(both.exit == 0);
    CHECK(contains(both.text, "1 revolute: A; 1 distance: B"));
  }
  const std::string twice = scene_file(
      "twice", kArm + R"("links": [{)" + kHinge + R"(}], "joints": [{)" + kHinge + R"(}], "run": {"until": 0.1})");
  check_mistake({"check '" + twice + "'", 3, {"joint 'A'", "taken"}});
}

// A scene in millimetres with gravity to match, and 1000 kg m^2 on 1 kg: 9810 m/s^2, and a radius of gyration of 32 m.
TEST_CASE("numbers that no machine has are warned of, in check and in run", "[mistakes][defect]") {
  for (const std::string& line :
       {"check " + defect("implausible"), "run " + defect("implausible") + " --no-picture --record implausible.csv"}) {
    const Called called = call(line);
    INFO(called.text);
    CHECK(called.exit == 0);
    CHECK(contains(called.text, "gravity is 9810 m/s^2; that of the Earth is 9.81"));
    CHECK(contains(called.text, "body 'r': the radius of gyration is 31.6 m, which is implausible for 1 kg"));
    CHECK(contains(called.text, "implausible.json:1:"));
  }
  CHECK(table_of("implausible").n_rows() == 11);
  const auto joined_at = [](const std::string& center) {
    return call("check '" + scene_file("far", R"("bodies": [{"name": "a", "mass": 1, "inertia": [1, 1, 1], "position": )" +
                                                  center + R"(}], "links": [{"name": "A", "type": "revolute", "p": "a",
      "s": "ground", "at": [0, 0, 0]}, {"name": "B", "type": "point_on_line", "p": "a", "s": "ground", "at": [0.3, 0, 0],
      "axis": "x"}], "run": {"until": 1})") +
                    "'")
        .text;
  };
  CHECK(contains(joined_at("[150, 0, 0]"),
                 "body 'a': its centre of mass is 149.7 m from its joints, which are 0.3 m apart; check the units"));
  CHECK_FALSE(contains(joined_at("[5, 0, 0]"), "centre of mass"));
  const auto turned =
      [](const std::string& angle) {
        return call("check '" + scene_file("turned", R"("bodies": [{"name": "a", "sphere": {"mass": 1, "radius": 0.1},
      "orientation": {"axis": "z", "angle": )" + angle + "}}], \"run\": {\"until\": 1}") +
                    "'")
            .text;
      };
  const std::string once = turned("45");
  INFO(once);
  CHECK(once.find("more than a revolution") == once.rfind("more than a revolution"));
  CHECK(contains(turned("45"), "is 45 rad, more than a revolution; if degrees are meant, write \"45 deg\""));
  CHECK_FALSE(contains(turned("6.2"), "more than a revolution"));
  CHECK_FALSE(contains(turned("\"450 deg\""), "more than a revolution"));
}

}  // namespace mistakes_test
