// SPDX-License-Identifier: BSD-3-Clause
// Scenes that once showed a defect of the program, each as it was, under its name.
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/gnuplot_here.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace defects_program_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::ordered_json;

namespace {

std::string text_of(const std::string& file) {
  std::ifstream in(kRunnerFolder + "/" + file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

// not_unique: two hinges share the door's weight along their common axis' normal.
TEST_CASE("every command with --json writes one document to standard output and nothing else", "[runner]") {
  const std::string door = "'" + scene_file("not_unique", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "door", "mass": 2, "inertia": [0.1, 0.2, 0.25], "position": [0.5, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0]},
              {"name": "B", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 1]}],
    "run": {"until": 0.1, "output": 0.1, "record": ["A.force_on_p_world_x"]})") +
                           "'";
  const auto json = [](const std::string& words) {
    const Called r = call(words + " --json 2>/dev/null");
    INFO(words << "\n" << r.text);
    CHECK(r.exit == 0);
    REQUIRE(Json::accept(r.text));
    return Json::parse(r.text);
  };
  CHECK(json("run " + door)["not_unique"] == Json::array({"A.force_on_p_world_x"}));
  for (const char* verb : {"check", "assemble", "statics", "matrices"}) json(verb + (" " + door));
  json("explain " + door + " A");
  json("sweep " + door + " --vary bodies.door.mass=1,2 --record not_unique_sweep.csv");
  CHECK(contains(call("run " + door).text, "reactions-not-unique: A.force_on_p_world_x"));
  CHECK_FALSE(contains(call("run " + door + " --quiet").text, "not unique"));
}

// mixed_units: an angle and a speed in one panel.
TEST_CASE("columns of several units that are drawn together have an axis for each unit", "[runner]") {
  require_gnuplot();
  const std::string scene = scene_file("mixed_units", R"(
    "bodies": [{"name": "r", "rod": {"mass": 0.5, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "r", "s": "ground", "at": [0, 0, 0]}],
    "forces": [{"name": "k", "type": "spring_damper", "p": "r", "s": "ground", "at_p": [1, 0, 0], "at_s": [2, 0, 0],
                "stiffness": 10, "free_length": 0.5}],
    "run": {"until": 1, "output": 0.1, "record": ["r.angle_z", "r.vx"], "draw": [["r.angle_z", "r.vx"]]})");
  CHECK(call("run '" + scene + "' --quiet --record mixed_units.csv").exit == 0);
  const std::string mixed = text_of("mixed_units.svg");
  CHECK(count(mixed, ">rad</") == 1);
  CHECK(count(mixed, ">m/s</") == 1);
  // The sample draws two angles, then a height and its rate.
  CHECK(call("run '" + std::string(paths::kScenes) + "/belt.json' --quiet --until 0.1 --record belt_units.csv").exit ==
        0);
  const std::string belt = text_of("belt_units.svg");
  CHECK(count(belt, ">rad</") == 1);
  CHECK(count(belt, ">m</") == 1);
  CHECK(count(belt, ">m/s</") == 1);
}

// event_never: a pendulum that swings between 0 and -pi is to pass -15 rad. Released level it comes to rest on the other
// side after 2 K(sin(pi/4)) / omega_0, where omega_0^2 = 3 g / (2 L).
TEST_CASE("an event that never happens is in the summary, with the nearest value", "[runner]") {
  const std::string scene = "'" + scene_file("event_never", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]},
              {"name": "latch", "type": "lock", "mask": "x y", "p": "rod", "s": "ground", "at_p": [1, 0, 0],
               "at_s": [0, -1, 0], "active": false}],
    "events": [{"name": "catch", "when": {"channel": "rod.angle_z", "crosses": -15}, "activate": ["latch"]},
               {"name": "late", "at": 7, "stop": true}],
    "run": {"until": 2, "output": 0.01, "record": ["rod.angle_z", "energy.total"]})") +
                            "' --no-picture --record event_never.csv";
  const Called said = call("run " + scene);
  INFO(said.text);
  CHECK(said.exit == 0);
  CHECK(contains(said.text, "event-missed: event 'catch': rod.angle_z did not cross -15 rad; nearest value -3.14"));
  CHECK(contains(said.text, "event-missed: event 'late': its time, 7 s, was not reached"));
  const Json result = Json::parse(call("run " + scene + " --json 2>/dev/null").text);
  const Json& missed = result["missed_events"];
  REQUIRE(missed.size() == 2);
  CHECK(missed[0]["event"] == "catch");
  CHECK(missed[0]["channel"] == "rod.angle_z");
  CHECK(missed[0]["unit"] == "rad");
  CHECK(missed[0]["crosses"] == -15);
  CHECK(std::abs(missed[0]["nearest"].get<double>() + 3.14159265358979) < 1e-3);
  const double K = 1.85407467730137, half = 2 * K / std::sqrt(1.5 * 9.81);
  CHECK(std::abs(missed[0]["t"].get<double>() - half) < 0.02);
  CHECK(missed[1]["at"] == 7);
  // One that happens is not mentioned.
  const Called met = call("run " + scene + " --set events.catch.when.crosses=-1.5707963267948966");
  CHECK_FALSE(contains(met.text, "event-missed: event 'catch'"));
  // One that is passed the other way: rz'^2 = 3 g/L sin(-rz), so that -1 rad is met at 0.375 s.
  const std::string other = " --set events.catch.when.crosses=-1 --set events.catch.when.direction=rising --until 0.9";
  CHECK(contains(call("run " + scene + other).text,
                 "did not rise through -1 rad; it crossed in the other direction at t = 0.375"));
}

TEST_CASE("a tolerance below the rounding error is rejected", "[runner]") {
  const std::string run = "run '" + std::string(paths::kScenes) + "/pendulum.json' --until 0.01 --no-picture ";
  check_refused(call(run + "--tolerance 1e-20"), 2,
                {"--tolerance", "1e-20 is below the round-off", "take 1e-13"});
  const std::string scene =
      scene_file("too_tight", kArm + R"("links": [{)" + kHinge + R"(}], "run": {"until": 1, "tolerance": 1e-20})");
  check_refused(call("run '" + scene + "'"), 3,
                {"too_tight.json:", "run.tolerance", "1e-20 is below the round-off"});
  CHECK(call(run + "--tolerance 1e-12 --record below.csv").exit == 0);
}

}  // namespace defects_program_test
