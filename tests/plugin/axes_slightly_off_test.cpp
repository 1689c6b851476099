// SPDX-License-Identifier: BSD-3-Clause
// Loops that errors of rounding or typing would lock, and those that laws move: what is released, held and reported.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tests/support/catch.h"
#include "tests/support/defect_runs.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace axes_slightly_off_test {

using namespace lockstep;
using namespace lockstep::testing;

TEST_CASE("a slightly wrong axis is released in a loop drawn roughly too, and next to a free body", "[runner]") {
  const auto scene = [](const std::string& axis, const std::string& more = "") {
    return scene_file("rough", R"("planar": "off", "bodies": [)" + more + R"(
      {"name": "crank", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.1, 0, 0]}},
      {"name": "coupler", "rod": {"mass": 1, "from": [0.1, 0.01, 0], "to": [0.3, 0.2, 0]}},
      {"name": "rocker", "rod": {"mass": 1, "from": [0.28, 0, 0], "to": [0.29, 0.25, 0]}}], "joints": [
      {"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0],
       "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 10}}},
      {"name": "B", "type": "revolute", "p": "coupler", "s": "crank", "at_p": [0.1, 0.01, 0], "at_s": [0.1, 0, 0],
       "axis": )" + axis + R"(},
      {"name": "C", "type": "revolute", "p": "coupler", "s": "rocker", "at_p": [0.3, 0.2, 0], "at_s": [0.29, 0.25, 0]},
      {"name": "D", "type": "revolute", "p": "rocker", "s": "ground", "at": [0.28, 0, 0]}],
      "run": {"until": 0.5, "tolerance": 1e-9, "record": ["rocker.angle_z"]})");
  };
  const auto last = [](const std::string& path) {
    const Called called = call("run '" + path + "' --no-picture --record rough.csv");
    INFO(called.text);
    REQUIRE(called.exit == 0);
    return std::pair(table_of("rough").last("rocker.angle_z"), called.text);
  };
  const double exact = last(scene("\"z\"")).first;
  for (const char* more : {"", R"({"name": "free", "particle": 1, "position": [2, 0, 0]},)"})
    for (const char* tilt : {"1e-7", "1e-5", "1e-3"}) {
      CAPTURE(more, tilt);
      const auto [angle, text] = last(scene(std::string("[") + tilt + ", 0, 1]", more));
      CHECK(std::abs(angle - exact) < 10 * std::stod(tilt) + 1e-6);
      CHECK(contains(text, "It is released"));
      CHECK(contains(text, "the given poses do not fit the joints"));
    }
}

// Up to the limit of the plane an axis counts as its normal, for coordinates as for constraints.
TEST_CASE("a joint whose axis is tilted by a rounding rotates as without it", "[runner]") {
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(std::string(paths::kScenes) + "/double_pendulum.json"));
  const auto last = [&](double tilt) {
    scene["joints"][0]["axis"] = {tilt, 0, 1};
    std::ofstream(kRunnerFolder + "/tilted.json") << scene;
    const Called called = call("run tilted.json --no-picture --record tilted.csv --until 1");
    INFO(called.text);
    REQUIRE(called.exit == 0);
    return table_of("tilted").last("q1");
  };
  const double exact = last(0);
  CHECK(std::abs(exact) > 0.1);
  for (const double tilt : {1e-13, 1e-12, 1e-10, -1e-10, 9e-10, 1.1e-9, 1e-8}) {
    CAPTURE(tilt);
    CHECK(std::abs(last(tilt) - exact) < 1e-4);
  }
}

// Whatever solves it: below the limit of what depends exactly, above it, and at it.
TEST_CASE("a four-bar of which one axis is slightly wrong swings like a four-bar in its plane", "[runner]") {
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(std::string(paths::kScenes) + "/four_bar.json"));
  scene["joints"][0].erase("drive");
  scene["gravity"] = {0, -9.81, 0}, scene["planar"] = "off";
  scene["run"] = {{"until", 0.5}, {"tolerance", 1e-9}, {"record", {"rocker.angle_z"}}};
  const auto last = [&](double tilt, const std::string& options) {
    scene["joints"][2]["axis"] = {tilt, 0, 1};
    std::ofstream(kRunnerFolder + "/swings.json") << scene;
    const Called called = call("run swings.json --no-picture --record swings.csv " + options);
    INFO(called.text);
    REQUIRE(called.exit == 0);
    return table_of("swings").last("rocker.angle_z");
  };
  const double exact = last(0, "--planar z");
  for (const char* options : {"", "--solver dense", "--formulation omega"})
    for (double tilt = 1e-12; tilt < 2e-3; tilt *= 10) {
      CAPTURE(options, tilt);
      CHECK(std::abs(last(tilt, options) - exact) < tilt + 1e-8);
    }
}

// A centre of mass far off makes positions nearly dependent that hold the joints together.
TEST_CASE("constraints without which joints open are not released", "[runner]") {
  nlohmann::json far = nlohmann::json::parse(std::ifstream(std::string(paths::kScenes) + "/four_bar.json"));
  far["bodies"][1]["center"] = {150, 0.04, 0};
  std::ofstream(kRunnerFolder + "/far.json") << far;
  const Called held = call("run far.json --no-picture --record far.csv");
  const Called plane = call("run " + sample("four_bar") + " --no-picture --record plane.csv");
  INFO(held.text);
  CHECK(contains(held.text, "centre of mass is 149.7 m from its joints"));
  CHECK(std::abs(table_of("far").last("coupler") - table_of("plane").last("coupler")) < 1e-6);
  CHECK(contains(held.text, "It is kept: its release would open joints by 0.02"));
  CHECK(contains(call("check far.json --nearly-redundant free").text, "its release would open joints by 0.02"));
}

TEST_CASE("channels give how far released constraints open", "[runner]") {
  const std::string door = scene_file("opens", R"("gravity": [0, 0, -9.81],
    "bodies": [{"name": "door", "box": {"mass": 30, "size": [0.9, 0.04, 2]}, "position": [0.45, 0, 1]}],
    "joints": [{"name": "low",  "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0.2],
                "start": {"velocity": {"rz": 1}}},
               {"name": "high", "type": "revolute", "p": "door", "s": "ground", "at": [1e-4, 0, 1.8]}],
    "run": {"until": 1, "record": ["low.rz", "high.violation", "high.C_x", "violation", "high.P.x", "high.S.x"]})");
  const Called called = call("run '" + door + "' --no-picture --record opens.csv");
  INFO(called.text);
  REQUIRE(called.exit == 0);
  const Table table = table_of("opens");
  const double open = 2 * 1e-4 * std::sin(0.5 * table.last("low.rz"));  // of a circle, a chord
  CHECK(open > 5e-5);
  CHECK(std::abs(table.last("high.C_x") - (table.last("high.P.x") - table.last("high.S.x"))) < 1e-12);
  CHECK(table.last("high.violation") > 0.7 * open);
  CHECK(table.last("high.violation") < 1.01 * open);
  CHECK(table.last("violation") == table.last("high.violation"));
}

TEST_CASE("hinges of the same bodies with axes apart are named", "[runner]") {
  const auto door = [](const std::string& start) {
    return scene_file("apart", R"("gravity": [0, 0, -9.81],
    "bodies": [{"name": "door", "box": {"mass": 30, "size": [0.9, 0.04, 2]}, "position": [0.45, 0, 1]}],
    "joints": [{"name": "low",  "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0.2])" +
                                   start + R"(},
               {"name": "high", "type": "revolute", "p": "door", "s": "ground", "at": [0.05, 0, 1.8]}],
    "run": {"until": 0.1})");
  };
  const std::string place =
      "correct the place of joint low or high: both connect the same bodies, but their axes are "
      "0.05 m apart";
  CHECK(contains(call("check '" + door("") + "'").text, place));
  const Called moving = call("run '" + door(R"(, "start": {"velocity": {"rz": 1}})") + "' --no-picture --record a.csv");
  INFO(moving.text);
  CHECK(moving.exit == 5);
  CHECK(contains(moving.text, "the mechanism is locked: its joints leave no degree of freedom"));
  CHECK(contains(moving.text, place));
}

TEST_CASE("contradicting drives are compared at the assembled pose", "[runner]") {
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(std::string(paths::kScenes) + "/four_bar.json"));
  scene["parameters"]["gap"] = "0 m";  // by which the coupler is drawn beside the others
  scene["bodies"][1]["position"] = "=B + [gap, 0, 0]";
  nlohmann::json &B = scene["joints"][1], &C = scene["joints"][2];
  B.erase("at"), B["at_p"] = "=B + [gap, 0, 0]", B["at_s"] = "B";
  C.erase("at"), C["at_p"] = "C", C["at_s"] = "=C + [gap, 0, 0]";
  scene["joints"][3]["drive"] = {{"axis", "rz"}, {"speed", 5}};
  std::ofstream(kRunnerFolder + "/contradict.json") << scene;
  const auto rates = [](const std::string& gap) {
    const std::string text = call("check contradict.json --set gap='" + gap + "'").text;
    const std::size_t at = text.find("but ");
    INFO(text);
    REQUIRE(contains(text, "is required of it by A.rz"));
    return text.substr(at, text.find(" is required") - at);
  };
  CHECK(rates("0 m") == rates("1 mm"));
}

TEST_CASE("a mechanism that laws of lengths and markers move is not called immovable", "[runner]") {
  for (const auto& [name, links] : {std::pair("stewart", "leg_1, leg_2"), {"moving_marker_ground", "hold"}}) {
    const Called called = call("check " + sample(name));
    INFO(called.text);
    CHECK(contains(called.text, "its motion is fully prescribed"));
    CHECK(contains(called.text, std::string("0, moved by the laws of ") + links));
  }
}

}  // namespace axes_slightly_off_test
