// SPDX-License-Identifier: BSD-3-Clause
// What the program says of results that are doubtful, and of starts that are not what was asked.
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include <lockstep/recorder.h>
#include "tests/support/catch.h"
#include "tests/support/open_defect.h"
#include "tests/support/four_bar_scene.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace runner_doubts_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::ordered_json;

namespace {

std::string own_scene(const std::string& name) {
  return "'" + std::string(paths::kSource) + "/tests/verification/scenes/" + name + ".json'";
}

/// A parallelogram that lies flat, its cranks along x.
std::string flat_parallelogram(const std::string& name, const std::string& start) {
  return scene_file(name, R"("gravity": [0, 0, 0], "bodies": [
    {"name": "left", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.3, 0, 0]}},
    {"name": "bar", "rod": {"mass": 1, "from": [0.3, 0, 0], "to": [1.4, 0, 0]}},
    {"name": "right", "rod": {"mass": 1, "from": [1.1, 0, 0], "to": [1.4, 0, 0]}}],
  "links": [
    {"name": "A", "type": "revolute", "p": "left", "s": "ground", "at": [0, 0, 0])" +
                              start + R"(},
    {"name": "B", "type": "revolute", "p": "bar", "s": "left", "at": [0.3, 0, 0]},
    {"name": "C", "type": "revolute", "p": "bar", "s": "right", "at": [1.4, 0, 0]},
    {"name": "D", "type": "revolute", "p": "right", "s": "ground", "at": [1.1, 0, 0]}],
  "run": {"until": 0.1, "integrator": "rk4", "step": 1e-3, "record": ["left.angle_z"]})");
}

const std::string kSlider = own_scene("slider_crank_equal_arms");

}  // namespace

// The crank's axis is passed at 0.1268 s first.
TEST_CASE("a passed singular configuration is reported for unprojected stages, and an error with --strict",
          "[runner]") {
  const std::string plain =
      "run " + kSlider + " --integrator rk4 --step 1e-3 --until 0.3 --no-picture --record doubt.csv";
  const Called said = call(plain);
  INFO(said.text);
  CHECK(said.exit == 0);
  CHECK(contains(said.text, "passed 1 singular configuration with unprojected stages, at t = 0.126"));
  CHECK(contains(said.text, "the motion after it may be on another branch"));
  CHECK(contains(said.text, "(joints "));
  const Called refused = call(plain + " --strict");
  INFO(refused.text);
  CHECK(refused.exit == 11);
  CHECK(contains(refused.text, "--strict: passed 1 singular configuration"));
  check_refused(call(plain + " --strict --quiet"), 11, {"--strict: passed 1 singular configuration"});
  const Called json = call(plain + " --json");
  const Json result = Json::parse(json.text);
  REQUIRE(result["singular_positions"].size() == 1);
  CHECK(result["singular_positions"][0]["t"].get<double>() == Approx(0.12676).margin(1e-4));
  CHECK(result["doubts"].size() == 1);
}

TEST_CASE("a sweep reports which of its runs passed a singular configuration with unprojected stages", "[runner]") {
  const Called swept =
      call("sweep " + kSlider + " --vary run.step=1e-3,2e-3 --integrator rk4 --until 0.3 --record swept.csv");
  INFO(swept.text);
  std::ifstream file(kRunnerFolder + "/swept.csv");
  std::string row;
  std::getline(file, row);
  for (int k = 0; k < 2; ++k) {
    REQUIRE(std::getline(file, row));
    INFO(row);
    CHECK(contains(row, "; passed 1 singular configuration with unprojected stages, first at t = 0.127"));
  }
  const Called sure = call("sweep " + kSlider + " --vary run.tolerance=1e-6,1e-8 --record swept.csv");
  INFO(sure.text);
  std::ifstream other(kRunnerFolder + "/swept.csv");
  for (int k = 0; k < 3; ++k) {
    REQUIRE(std::getline(other, row));
    CHECK_FALSE(contains(row, "passed"));
  }
}

TEST_CASE("a run that resolves its singular configurations is not an error", "[runner]") {
  const Called r = call("run " + kSlider + " --strict --tolerance 1e-8 --no-picture --record sure.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK_FALSE(contains(r.text, "DOUBTFUL"));
}

TEST_CASE("a tolerance below the attainable one is reported, and the run continues", "[runner]") {
  const Called r = call("run '" + std::string(paths::kScenes) +
                        "/nfourbar_40.json' --tolerance 1e-13 --until 2 --no-picture --record forty.csv --json");
  INFO(r.text);
  CHECK(r.exit == 0);
  const Json result = Json::parse(r.text);
  CHECK(result["t"] == 2);
  CHECK(result["status"] == "ok");
  REQUIRE(!result["doubts"].empty());
  CHECK(contains(result["doubts"][0].get<std::string>(), "the tolerance of 1e-13 was not reached"));
}

// The crank makes a whole turn, and the hinge between it and the coupler one back.
TEST_CASE("recorded angles of all joints of a loop begin in the requested revolution", "[runner]") {
  const auto scene = [](const std::string& name, const std::string& angle) {
    const std::string start = R"(, "start": {"position": {"rz": ")" + angle + R"("}})";
    return scene_file(name, R"("gravity": [0, 0, 0], )" + four_bar({.A = start, .closed = true}) +
                                R"(, "run": {"until": 0, "record": ["A.rz", "B.rz"]})");
  };
  const auto angles = [&](const std::string& file) {
    const Called said = call("run --no-picture --quiet --record - " + file);
    INFO(said.text);
    REQUIRE(said.exit == 0);
    std::istringstream rows(said.text);
    std::string row, last;
    while (std::getline(rows, row)) last = row;
    double t = 0, A = 0, B = 0;
    REQUIRE(std::sscanf(last.c_str(), "%lf,%lf,%lf", &t, &A, &B) == 3);
    return std::pair(A, B);
  };
  const auto [A0, B0] = angles(scene("within", "20 deg"));
  const auto [A1, B1] = angles(scene("beyond", "380 deg"));
  CHECK(A0 == Approx(20 * kPi / 180).margin(1e-9));
  CHECK(A1 - A0 == Approx(kTwoPi).margin(1e-9));
  CHECK(B1 - B0 == Approx(-kTwoPi).margin(1e-9));
  const Called sweep = call("sweep " + scene("swept", "20 deg") +
                            " --record turns.csv --vary links.A.start.position.rz='20 deg,380 deg'");
  INFO(sweep.text);
  CHECK(sweep.exit == 0);
}

// A spring of 20 N/m that says half of what it stores; and a rod that is let go from its hinge by itself.
TEST_CASE("if energy is not conserved the summary lists possible causes", "[runner]") {
  const std::string spring = scene_file("half", R"("gravity": [0, 0, 0],
    "bodies": [{"name": "arm", "particle": 1, "position": [1, 0, 0]}],
    "forces": [{"name": "F", "type": "naughty_force", "p": "arm", "at": [0, 0, 0], "does": "half a potential"}],
    "run": {"until": 1, "output": 0.1, "record": ["arm.x"]})");
  const Called half = call("run '" + spring + "' --plugin '" + kModules + "/naughty.so'");
  INFO(half.text);
  CHECK(half.exit == 9);
  CHECK(contains(half.text, "WRONG     energy-not-conserved: "));
  CHECK(contains(half.text, "; first test naughty_force by check_force; otherwise "));
  CHECK_FALSE(contains(half.text, "e+02 %"));
  CHECK(contains(half.text, "energy-suspect: force 'F' (naughty_force), which gives "));
  const std::string rod = scene_file("let_go", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": "rk4", "step": 0.1, "until": 5, "formulation": "omega", "stabilization": "none",
            "energy_limit": 1e-9, "violation_limit": 1, "record": ["rod.x"]})");
  const Called open = call("run '" + rod + "' --json");
  INFO(open.text);
  const Json energy = Json::parse(open.text)["energy"];
  CHECK(energy["verdict"] == "not conserved");
  REQUIRE_FALSE(energy["suspects"].empty());
  CHECK(contains(energy["suspects"][0].get<std::string>(), "use stabilization project"));
}

// Two rods between which a bar grows longer until they are stretched, at t = 0.528 s: sqrt(3.2) + 0.4 t = 1 + 1.
TEST_CASE("a mechanism that a law drives into a lock names that law, by every method", "[runner]") {
  const std::string scene = scene_file("stretched", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}},
               {"name": "c", "rod": {"mass": 1, "from": [1, 0, 0], "to": [1.6, 0.8, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "c", "s": "a", "at": [1, 0, 0]},
              {"name": "C", "type": "distance", "p": "c", "s": "ground", "at_p": [1.6, 0.8, 0], "at_s": [0, 0, 0],
               "length": {"type": "formula", "y": "=sqrt(3.2)+0.4*t"}}],
    "run": {"until": 1, "output": 0.1, "record": ["a.x"]})");
  for (const char* method : {"dopri5", "dop853", "radau5", "rk4", "generalized_alpha", "rattle2", "rattle4"}) {
    const Called r = call("run --no-picture --step 0.01 '" + scene + "' --integrator " + method);
    INFO(method << ": " << r.text);
    CHECK(r.exit == 6);
    CHECK(contains(r.text, "'C'"));
  }
}

// At 0.52 s a sample falls on the position itself (the indicator is 2e-8), where the force in A is 18.62 N.
TEST_CASE("reactions in a singular configuration that have a limit are not uncertain", "[runner]") {
  std::ifstream in(std::string(paths::kSource) + "/tests/verification/scenes/slider_crank_equal_arms.json");
  Json scene = Json::parse(in);
  scene["run"]["record"] = {"A.force_on_p_link_y"};
  scene["run"]["output"] = 0.02;
  std::ofstream(kRunnerFolder + "/limit.json") << scene;
  const Called r = call("run limit.json --tolerance 1e-8 --no-picture --record limit.csv --json");
  INFO(r.text);
  CHECK(Json::parse(r.text)["doubts"].empty());
  const Table table = read_csv(kRunnerFolder + "/limit.csv");
  CHECK(table["t"][26] == Approx(0.52));
  CHECK(table["A.force_on_p_link_y"][26] == Approx(18.62).epsilon(1e-3));
}

// The reaction of A grows as 1/t from the start on: there it has no value.
TEST_CASE("reactions near a singular configuration are reported", "[runner]") {
  const Called r = call("run '" + defect_scene("start_in_change_point") + "' --no-picture --record beside.csv --json");
  INFO(r.text);
  const Json result = Json::parse(r.text.substr(r.text.find("{\n")));
  REQUIRE(result["doubts"].size() == 1);
  CHECK(contains(result["doubts"][0].get<std::string>(), "the reactions at t = 0 s are uncertain"));
}

TEST_CASE("of many instants with uncertain reactions the first are named and all counted", "[runner]") {
  std::ifstream in(defect_scene("start_in_change_point"));
  Json scene = Json::parse(in);
  scene["run"]["times"] = Json::array();
  for (int k = 0; k < 20; ++k) scene["run"]["times"].push_back(2e-6 * k);
  scene["run"]["until"] = 0.01;
  std::ofstream(kRunnerFolder + "/many.json") << scene;
  const Called r = call("run many.json --no-picture --record many.csv --json");
  INFO(r.text);
  const Json result = Json::parse(r.text.substr(r.text.find("{\n")));
  REQUIRE(result["doubts"].size() == 1);
  const std::string found = result["doubts"][0];
  CHECK(contains(found, "the reactions at t = 0, 2e-06, 4e-06, 6e-06, 8e-06, ... s (20 times) are uncertain"));
}

TEST_CASE("columns of friction and of drives are doubted as reactions are", "[runner]") {
  std::ifstream in(defect_scene("start_in_change_point"));
  Json scene = Json::parse(in);
  scene["links"][0]["friction"] = {{"mu", 1e-6}, {"radius", "10 mm"}};
  scene["run"]["record"] = {"A.friction.radial_force"};
  std::ofstream(kRunnerFolder + "/rubbing.json") << scene;
  const Called r = call("run rubbing.json --strict --no-picture --record rubbing.csv");
  INFO(r.text);
  CHECK(r.exit == 11);
  CHECK(contains(r.text, "the reactions at t = 0"));
}

// By so loose a tolerance all is uncertain, and nothing is magnified.
TEST_CASE("reactions far from singular configurations are not uncertain because of a loose tolerance", "[runner]") {
  const Called r = call("run '" + kFourBar + "' --tolerance 1e-2 --until 0.1 --no-picture --record loose.csv --json");
  INFO(r.text);
  CHECK(Json::parse(r.text)["doubts"].empty());
}

TEST_CASE("a start in a singular configuration is reported with its branches", "[runner]") {
  const Called rest = call("run '" + flat_parallelogram("flat_rest.json", "") + "' --no-picture");
  INFO(rest.text);
  CHECK(contains(rest.text, "the start is a singular configuration: 2 instantaneous degrees of freedom, 2 branches: "));
  CHECK(contains(rest.text, "It is at rest"));
  const Called check = call("check '" + flat_parallelogram("flat_rest.json", "") + "' --json");
  CHECK(contains(check.text, "warning: singular-start: the start is a singular configuration"));
  const Json j = Json::parse(check.text.substr(check.text.find("{\n")))["singular_position"];
  CHECK(j["in"] == true);
  CHECK(j["branches"].size() == 2);
}

// Crank and rocker of 0.1 m, coupler and base of 0.2 m: in line at 0, and the rocker may turn either way.
TEST_CASE("a driven mechanism that starts in a singular configuration is reported, one near it is not", "[runner]") {
  const std::string bars = " --set crank=0.1 --set rocker=0.1 --set coupler=0.2 --set base=0.2 --set theta=";
  for (const char* command : {"check '", "run '"}) {
    const std::string outputs = *command == 'r' ? " --no-picture --until 0.01 --record line.csv" : "";
    const Called in_line = call(command + kFourBar + "'" + bars + "0" + outputs);
    INFO(in_line.text);
    CHECK(contains(in_line.text,
                   "singular-start: the start is a singular configuration: with A.rz prescribed, the loop "
                   "of joints A, B, C and D may continue in several ways, or not at all"));
    CHECK_FALSE(contains(call(command + kFourBar + "'" + bars + "0.01" + outputs).text, "singular-start"));
  }
  // A drive that holds its joint leaves no way to continue.
  const Called held = call("check '" + kFourBar + "'" + bars + "0 --set joints.A.drive.law=0");
  INFO(held.text);
  CHECK_FALSE(contains(held.text, "several ways"));
}

TEST_CASE("a mechanism without a degree of freedom is reported, unless a law moves it or an event releases it",
          "[runner]") {
  const std::string said = "no degree of freedom: the constraints of A and L hold all 3 unknown velocities";
  const auto run = [](const std::string& length, const std::string& more) {
    return call("run '" +
                scene_file("held.json", R"("gravity": [0, -9.81, 0], )" + kArm + R"("links": [{)" + kHinge +
                                            R"(}, {"name": "L", "type": "distance", "p": "arm", "s": "ground",
      "at_p": [1, 0, 0], "at_s": [1, 1, 0], "length": )" +
                                            length + "}], " + more + R"("run": {"until": 0.1, "output": 0.05})") +
                "' --no-picture --record held.csv");
  };
  const Called held = run("1", "");
  INFO(held.text);
  CHECK(held.exit == 0);
  CHECK(contains(held.text, said));
  const Called law = run(R"({"type": "harmonic_rise", "y0": 1, "rise": 0.1, "duration": 0.05, "t0": 0.02})", "");
  INFO(law.text);
  CHECK(law.exit == 0);
  CHECK_FALSE(contains(law.text, "no degree of freedom"));
  const Called event = run("1", R"("events": [{"name": "cut", "at": 0.05, "deactivate": ["L"]}], )");
  INFO(event.text);
  CHECK(event.exit == 0);
  CHECK_FALSE(contains(event.text, "no degree of freedom"));
  const std::string still = "run '" + std::string(paths::kScenes) + "/four_bar.json' --set links.A.drive.law.slope=0";
  CHECK(contains(
      call(still + " --no-picture --record held.csv").text,
      "no degree of freedom is left: constant laws hold A.rz; for a constant speed, give the drive \"speed\""));
  CHECK_FALSE(
      contains(call("run '" + std::string(paths::kScenes) + "/four_bar.json' --no-picture --record held.csv").text,
               "no degree of freedom"));
}

TEST_CASE("check reports free motions in words", "[runner]") {
  const Called r = call("check '" + std::string(paths::kScenes) + "/nfourbar_2.json' --verbose");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text, " rotates about "));
  CHECK(contains(r.text, " follow"));
  const Called four = call("check '" + std::string(paths::kScenes) + "/double_pendulum.json' --json");
  CHECK(Json::parse(four.text)["singular_position"].is_null());  // no loop
}

TEST_CASE("an assembled start that is far from the one given ends with its own code", "[runner]") {
  const std::string bar = "assemble '" + std::string(paths::kScenes) + "/four_bar.json'";
  CHECK(call(bar).exit == 0);
  const std::string apart = "assemble '" + scene_file("apart.json", R"("bodies": [{"name": "a", "particle": 1},
    {"name": "b", "particle": 1, "position": [1, 0, 0]}], "links": [{"name": "J", "type": "spherical", "p": "a", "s": "b"}])") +
                            "'";
  const Called far = call(apart + " --within '10 cm'");
  INFO(far.text);
  CHECK(far.exit == 11);
  CHECK(contains(far.text, "start-far: the assembled start is 0.5 m from the given one"));
  CHECK_FALSE(contains(far.text, "lockstep assemble"));
  check_refused(call(apart), 11,
                {"constraint error of the given poses  1 m", "largest move                         0.5 m",
                 "  of                                 a"});
  CHECK(row_of(call(apart).text, "J") == "J 1");
  CHECK(call(apart + " --within 2").exit == 0);
}

}  // namespace runner_doubts_test
