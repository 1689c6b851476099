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
  CHECK(contains(held.text, "It is kept: without them joints open by 0.1"));
  CHECK(contains(call("check far.json --nearly-redundant free").text, "without them joints open by 0.1"));
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
