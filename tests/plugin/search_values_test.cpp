// SPDX-License-Identifier: BSD-3-Clause
// The commands find, optimize and sensitivity, as a person calls them.
#include <cmath>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace search_values_test {

using namespace lockstep::testing;
using Json = nlohmann::json;
using std::numbers::pi;

namespace {

// A point mass m = 2 kg at r = 0.3 m, driven at constant speed; with gravity its pin carries m r w^2 + m g at the bottom.
// Rows are a third of a revolution apart, so that they miss the bottom.
std::string rotor() {
  return scene_file("rotor", R"(
  "parameters": {"speed": "10 rad/s", "r": "300 mm"}, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "mass", "mass": 2, "inertia": [0.01, 0.01, 0.01], "position": ["=r", 0, 0]}],
  "joints": [{"name": "A", "type": "revolute", "p": "mass", "s": "ground", "at": [0, 0, 0],
              "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "=speed"}}}],
  "run": {"until": 2, "output": 0.23, "tolerance": 1e-9,
          "record": [{"F": "=norm(A.force_on_p_world)"}, {"phi": "A.rz"}]})");
}

// A slider-crank without gravity: crank 1 kg and 0.1 m, rod 2 kg and 0.3 m, slider 3 kg, one revolution in 1 s. The
// counterweight is at 0.1 m, opposite to the crank.
std::string engine() {
  return scene_file("engine", R"(
  "parameters": {"crank": "100 mm", "rod": "300 mm", "counterweight": "1 kg"},
  "points": {"A": [0, 0, 0], "B": ["=crank", 0, 0], "C": "=B + [rod, 0, 0]"}, "gravity": [0, 0, 0],
  "bodies": [{"name": "crank", "rod": {"mass": 1, "from": "A", "to": "B"}},
             {"name": "rod", "rod": {"mass": 2, "from": "B", "to": "C"}},
             {"name": "slider", "mass": 3, "inertia": [0.01, 0.01, 0.01], "position": "C"},
             {"name": "weight", "mass": "=counterweight", "inertia": [0.01, 0.01, 0.01], "position": "=A - [crank, 0, 0]"}],
  "joints": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": "A",
              "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 6.283185307179586}}},
             {"name": "B", "type": "revolute", "p": "rod", "s": "crank", "at": "B"},
             {"name": "C", "type": "revolute", "p": "slider", "s": "rod", "at": "C"},
             {"name": "guide", "type": "prismatic", "p": "slider", "s": "ground", "at": "C", "axis": "x"},
             {"name": "welded", "type": "weld", "p": "weight", "s": "crank", "at": "A"}],
  "run": {"until": 1, "output": 0.05, "tolerance": 1e-9,
          "record": [{"shaking": "=norm(A.force_on_p_world + guide.force_on_p_world)"}]})");
}

}  // namespace

TEST_CASE("find: the speed at which the peak force of a bearing reaches a limit", "[plugin][runner]") {
  const double wanted = std::sqrt((100 - 2 * 9.81) / (2 * 0.3));
  const std::string words = "find " + rotor() + " --vary speed=\"5 rad/s:20 rad/s\" --reach \"max(F) = 100 N\"";
  const Json found = json_of(words + " --json");
  CHECK(std::abs(found["values"]["speed"].get<double>() - wanted) <= 1e-6 * wanted);
  CHECK(std::abs(found["value"].get<double>() - 100) <= 1e-5);
  CHECK(found["unit"] == "N");
  CHECK(found["runs"].get<int>() < 15);
  const Called text = call(words + " --write rotor_found.json");
  INFO(text.text);
  CHECK(text.exit == 0);
  CHECK(value_of(text.text, "found").starts_with("speed = 11.5744"));
  CHECK(value_of(text.text, "reached").starts_with("max(F) = 100"));
  // The scene that is written has the speed: its run has this force.
  const Called run = call("run rotor_found.json --summary --no-picture");
  INFO(run.text);
  CHECK(run.exit == 0);
  CHECK(contains(run.text, "100 N"));
}

TEST_CASE("find: the last value of a column, and channels that are no columns", "[plugin][runner]") {
  // phi is 2 s times the speed; the turns counted in it are not lost.
  const Json last = json_of("find " + rotor() + " --vary speed=5:20 --reach \"phi = 7 pi rad\" --json");
  CHECK(std::abs(last["values"]["speed"].get<double>() - 3.5 * pi) <= 1e-6);
  const Json mean = json_of("find " + rotor() + " --vary r=0.1:1 --reach \"mass.vx^2 + mass.vy^2 = 16 m^2/s^2\" --json");
  CHECK(std::abs(mean["values"]["r"].get<double>() - 0.4) <= 1e-6);
}

TEST_CASE("find: what cannot be found is an error with the next move", "[plugin][runner]") {
  const std::string begin = "find " + rotor() + " --vary speed=5:20 --reach ";
  check_refused(call(begin + "\"max(F) = 1 kN\""), 1,
                {"max(F) is 34.62 N with speed = 5 rad/s", "259.62 N with speed = 20 rad/s", "both are below", "lockstep sweep"});
  check_refused(call(begin + "\"max(F) = 3 m\""), 2, {"--reach", "N", "m"});
  check_refused(call(begin + "\"max(G) = 3 N\""), 2, {"--reach", "G"});
  check_refused(call(begin + "\"max(F)\""), 2, {"compares nothing"});
  check_refused(call(begin + "\"max(F) < 3 N\""), 2, {"is not an equation"});
  check_refused(call("find " + rotor() + " --vary speed=5:20:3 --reach \"max(F) = 100 N\""), 2, {"expected NAME=a:b"});
  check_refused(call("find " + rotor() + " --vary speed=20:5 --reach \"max(F) = 100 N\""), 2, {"a smaller to a larger"});
  // sign(phi - 5 rad) jumps from -1 to 1.
  check_refused(call(begin + "\"sign(phi - 25 rad) = 0\""), 1, {"jumps over the value"});
  // The rod is too short for the crank at one end of the range.
  check_refused(call("find " + engine() + " --vary rod=\"50 mm:300 mm\" --reach \"max(shaking) = 10 N\""), 1,
                {"the run with rod = 50 mm failed"});
}

}  // namespace search_values_test
