// SPDX-License-Identifier: BSD-3-Clause
// What the program decides and reports about constraints that nearly depend on one another.
#include <cmath>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace runner_decided_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::json;

TEST_CASE("runner: nearly dependent constraints are released, and are held or reported on request",
          "[plugin][runner]") {
  const std::string door = "'" + std::string(paths::kSource) + "/tests/stability/scenes/door.json'";
  const Json free = Json::parse(call("check " + door + " --json").text);
  CHECK(free["freedoms"] == 1);
  REQUIRE(free["nearly_redundant"].size() == 1);
  CHECK(free["nearly_redundant"][0]["decided"] == "free");
  CHECK(free["nearly_redundant"][0]["left_out"].size() == 5);
  CHECK(free["nearly_redundant"][0]["singular_value"].get<double>() < 1e-6);
  const auto after_warnings = [](const std::string& words) {  // that assembly took the start velocities away
    const std::string text = call(words).text;
    REQUIRE(text.find('{') != std::string::npos);
    return Json::parse(text.substr(text.find('{')));
  };
  const Json held = after_warnings("check " + door + " --nearly-redundant held --json");
  CHECK(held["freedoms"] == 0);
  REQUIRE(held["nearly_redundant"].size() == 1);
  CHECK(held["nearly_redundant"][0]["decided"] == "held");
  CHECK(held["nearly_redundant"][0]["left_out"].size() == 4);
  // Constraints that are left out are counted as redundant.
  for (const auto& [choice, left_out] : {std::pair(&held, 4), std::pair(&free, 5)}) {
    CHECK((*choice)["rows"] == 10);
    CHECK((*choice)["redundant"] == left_out);
    int too_many = 0;
    for (const Json& set : (*choice)["dependencies"]) {
      too_many += set["too_many"].get<int>();
      if (set["nearly"] == 1) CHECK(set["rows"] == Json{"low.y", "low.e1", "high.y", "high.e1"});
    }
    CHECK(too_many == 4);
  }
  const std::string verbose = call("check " + door + " --verbose --nearly-redundant held").text;
  CHECK(value_of(verbose, "constraints") == "10");
  CHECK(value_of(verbose, "redundant constraints") == "4");
  CHECK(contains(verbose, "4 of these dropped: high (x z e1 e2)\n"));
  const Json told = after_warnings("check " + door + " --nearly-redundant report --json");
  CHECK(told["freedoms"] == 0);
  REQUIRE(told["nearly_redundant"].size() == 1);
  CHECK(told["nearly_redundant"][0]["decided"] == "reported");
  CHECK(told["nearly_redundant"][0]["left_out"].empty());
  CHECK(told["nearly_redundant"][0]["rows"] == Json{"low.y", "low.e1", "high.y", "high.e1"});
  for (const std::string solver : {"schur", "block", "sparse", "dense"}) {
    for (const std::string choice : {" --nearly-redundant free", ""}) {
      const Json turned = after_warnings(  // which reactions are not unique
          "run " + door + " --no-picture --record door_free.csv --json --solver " + solver + choice);
      CAPTURE(solver, choice);
      CHECK(turned["status"] == "ok");
      CHECK(turned["steps"].get<long>() < 200);
      CHECK(std::abs(turned["columns"][0]["final"].get<double>() - 1) < 1e-6);  // turns on at 1 rad/s
      REQUIRE(turned["nearly_redundant"].size() == 1);
      CHECK(turned["nearly_redundant"][0]["decided"] == "free");
    }
    const Json still = after_warnings(
        "run " + door + " --no-picture --record door_held.csv --json --nearly-redundant held --solver " + solver);
    CHECK(still["status"] == "ok");
    CHECK(still["nearly_redundant"][0]["decided"] == "held");
    CHECK(std::abs(still["columns"][0]["final"].get<double>()) < 1e-6);
  }
  CHECK(contains(call("run " + door + " --no-picture --record door_free.csv").text,
                 "It is released. Left out, with the redundant ones: high (x y"));
  CHECK(contains(call("check " + door + " --nearly-redundant held").text, "It is kept, so it may lock the mechanism"));
}

// Whether its solver then refuses the start or not.
TEST_CASE("runner: a run names nearly dependent constraints, their singular value and both choices",
          "[plugin][runner]") {
  const std::string door = "'" + std::string(paths::kSource) + "/tests/stability/scenes/door.json'";
  for (const std::string& words : {"check " + door, "run " + door + " --until 0.001 --no-picture --record door_told.csv"})
    for (const bool told : {true, false}) {
      const Called called = call(words + (told ? " --nearly-redundant report" : ""));
      INFO(called.text);
      CHECK(contains(
          called.text,
          "1 of the constraints low and high (each y e1) is nearly redundant (relative singular value 5.4e-08, "));
      CHECK(contains(called.text, told ? "Solvers may differ" : "It is released"));
      CHECK(contains(called.text,
                     told ? "\"nearly_redundant\": \"held\" or \"free\"" : "To hold it: --nearly-redundant held"));
      if (!told) CHECK(called.exit == 0);
    }
}

TEST_CASE("runner: what is decided at the start does not go with events that switch its links", "[plugin][runner]") {
  std::ifstream in(std::string(paths::kSource) + "/tests/stability/scenes/door.json");
  Json scene = Json::parse(in);
  scene["events"] = Json::parse(R"([{"name": "open", "at": 0.5, "deactivate": ["low"]}])");
  std::ofstream(kRunnerFolder + "/door_opens.json") << scene;
  for (const std::string choice : {"free", "held"})
    for (const std::string verb : {"check", "run --no-picture --record door_opens.csv"}) {
      const Called called = call(verb + " door_opens.json --nearly-redundant " + choice);
      INFO(called.text);
      CHECK(called.exit != 0);
      CHECK(contains(called.text, "event 'open' switches joint 'low'"));
      CHECK(contains(called.text, "\"" + choice + "\""));
    }
  const Called by_itself = call("check door_opens.json");  // which decides nothing then, and says why
  INFO(by_itself.text);
  CHECK(by_itself.exit == 0);
  CHECK(contains(by_itself.text, "Not decided: event 'open' switches joints of such a loop"));
}

TEST_CASE("runner: constraints are released by default with other events, and are reported with one-sided joints",
          "[plugin][runner]") {
  std::ifstream in(std::string(paths::kSource) + "/tests/stability/scenes/door.json");
  const Json door = Json::parse(in);
  const auto check = [&](const std::string& name, const Json& scene) {
    std::ofstream(kRunnerFolder + "/" + name + ".json") << scene;
    const Called called = call("check " + name + ".json --json");
    INFO(called.text);
    const Json found = Json::parse(called.text.substr(called.text.find('{')));
    REQUIRE(found["nearly_redundant"].size() == 1);
    return found["nearly_redundant"][0]["decided"].get<std::string>();
  };
  Json knob = door;
  knob["bodies"].push_back(
      Json::parse(R"({"name": "knob", "mass": 1, "inertia": [0.01, 0.01, 0.01], "position": [0.9, 0, 1]})"));
  knob["links"].push_back(
      Json::parse(R"({"name": "shaft", "type": "revolute", "p": "knob", "s": "door", "at": [0.9, 0, 1]})"));
  knob["events"] = Json::parse(R"([{"name": "off", "at": 0.5, "deactivate": ["shaft"]}])");
  CHECK(check("door_knob", knob) == "free");
  Json stop = door;
  stop["links"].push_back(Json::parse(
      R"({"name": "stop", "type": "stop", "p": "door", "s": "ground", "at": [0, 0, 0.2], "coordinate": "rz", "high": 1})"));
  CHECK(check("door_stop", stop) == "reported");
  // With 60 rods on it 310 rows in space, 124 in its plane.
  Json rods = door;
  for (int k = 0; k < 60; ++k) {
    const std::string name = "rod_" + std::to_string(k), before = k == 0 ? "door" : "rod_" + std::to_string(k - 1);
    const Json from = {0.9 + k, 0, 1}, to = {1.9 + k, 0, 1};
    rods["bodies"].push_back({{"name", name}, {"rod", {{"mass", 0.1}, {"from", from}, {"to", to}}}});
    rods["links"].push_back(
        {{"name", name + "_hinge"}, {"type", "revolute"}, {"p", name}, {"s", before}, {"at", from}});
  }
  rods["planar"] = "off", rods["gravity"] = {0, 2, 0};
  CHECK(check("door_rods", rods) == "reported");
  rods["planar"] = "z";
  CHECK(check("door_rods_flat", rods) == "free");
}

}  // namespace runner_decided_test
