// SPDX-License-Identifier: BSD-3-Clause
// What depends on reactions that are not unique is in doubt: friction, events and requirements; and nothing else is.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/load_cell.h"
#include "tests/support/open_defect.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace shares_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::ordered_json;

namespace {

const std::string kCode = "depends-on-share";

// A door on two hinges, at rest; the keys follow those of the scene.
std::string door(const std::string& keys, const std::string& on_low = "", const std::string& on_high = "") {
  return scene_file("shared_door",
                    R"("gravity": [0, 0, -9.81], "bodies": [{"name": "door", "box": {"mass": 10, "size": [1, 0.05, 2]},
      "position": [0.5, 0, 1]}],
    "links": [{"name": "low", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0.3])" +
                        on_low +
                        R"(}, {"name": "high", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 1.7])" +
                        on_high + R"(}], )" + keys + R"("run": {"until": 0.1, "output": 0.05, "record": ["low.rz"]})");
}

const std::string kRubs = R"(, "friction": {"mu": 0.1, "radius": "10 mm"})";

// The sample four-bar, whose hinges share forces along their axes and moments about x and y.
std::string four_bar(const Json& changes) {
  std::ifstream in(std::string(paths::kScenes) + "/four_bar.json");
  Json scene = Json::parse(in);
  scene.merge_patch(changes);
  if (changes.contains("friction")) scene["joints"][1]["friction"] = changes["friction"], scene.erase("friction");
  scene["run"]["until"] = 0.05;
  const std::string file = kRunnerFolder + "/shared_four_bar.json";
  std::ofstream(file) << scene;
  return file;
}

// The messages of the kind in what a command prints as JSON.
std::vector<std::string> found(const std::string& words) {
  const Called r = shell("lockstep " + words + " --json 2>/dev/null");
  INFO(words << '\n' << r.text);
  std::vector<std::string> messages;
  const Json result = Json::parse(r.text);
  for (const Json& f : result["findings"])
    if (f["code"] == kCode) messages.push_back(f["message"].get<std::string>());
  return messages;
}

std::vector<std::string> found_in_run(const std::string& file, const std::string& options = "") {
  return found("run '" + file + "' --no-picture --record shared.csv " + options);
}

void check_one(const std::vector<std::string>& messages, const std::vector<std::string>& words) {
  REQUIRE(messages.size() == 1);
  INFO(messages[0]);
  for (const std::string& each : words) CHECK(contains(messages[0], each));
}

}  // namespace

TEST_CASE("friction by reactions that are not unique is in doubt in a run, and an error with --strict",
          "[runner][findings]") {
  const std::string file = door("", kRubs, kRubs);
  const Called r = call("run '" + file + "' --no-picture --record shared.csv");
  INFO(r.text);
  CHECK(r.exit == 0);
  CHECK(contains(r.text,
                 "DOUBT     depends-on-share: the result depends on how redundant constraints share a load, by force "
                 "'low.friction' (joint low) and force 'high.friction' (joint high); release"));
  const Json j = json_of("run '" + file + "' --no-picture --record shared.csv --json");
  CHECK(j["doubts"].size() == 1);
  CHECK(j["warnings"].empty());
  CHECK(call("run '" + file + "' --no-picture --record shared.csv --strict").exit == 11);
  CHECK(call("run '" + file + "' --no-picture --record shared.csv --strict --quiet").exit == 11);
  CHECK(call("run '" + door("") + "' --no-picture --record shared.csv --strict").exit == 0);
}

TEST_CASE("check and sweep find what depends on reactions that are not unique", "[runner][findings]") {
  const std::string file = door("", "", kRubs);
  check_one(found("check '" + file + "'"), {"force 'high.friction' (joint high)"});
  check_one(found("check '" + file + "' --set links.high.at.0=1e-5"),
            {"(joint high)"});  // then low or high has no load
  const Called r = call("sweep '" + file + "' --vary gravity.2=-9,-1 --record shared_sweep.csv");
  INFO(r.text);
  CHECK(contains(r.text, "doubt: depends-on-share: the result depends on"));
  CHECK(contains(r.text, "(in 2 runs)"));
}

TEST_CASE("the verdict of a host's run has what depends on reactions that are not unique", "[simulation][findings]") {
  const auto findings = [](const std::string& file, bool cell = false) {
    Mechanism m = read_mechanism(file, builtin_registry());
    if (cell) system_of(m).add(std::make_unique<LoadCell>("cell", m.system.link("low")));
    Simulation run(std::move(m));
    run.run();
    std::vector<std::string> messages;
    for (const Finding& f : run.verdict().findings)
      if (f.code() == kCode) messages.push_back(f.message);
    CHECK(run.verdict().right);
    return messages;
  };
  check_one(findings(door("", kRubs)), {"force 'low.friction' (joint low)"});
  CHECK(findings(door("")).empty());
  CHECK(findings(door(""), true).empty());  // a force that reads and does not push
}

TEST_CASE("an event and a requirement by reactions that are not unique are in doubt", "[runner][findings]") {
  const auto event = [](const std::string& channel) {
    return R"("events": [{"name": "loose", "when": {"channel": ")" + channel +
           R"(", "crosses": 1000}, "stop": true}], )";
  };
  check_one(found_in_run(door(event("low.force_on_p_world_z"))), {"event 'loose' (low.force_on_p_world_z)"});
  check_one(found_in_run(door(event("=norm(high.force_on_p_world)"))),
            {"event 'loose' (=norm(high.force_on_p_world))"});
  check_one(found_in_run(door(R"("require": [{"holds": "=abs(low.force_on_p_world_x) < 5 kN"}], )")),
            {"requirement 'holds' (abs(low.force_on_p_world_x) < 5 kN)"});
  CHECK(found_in_run(door(event("door.ax"))).empty());
}

// In space the four hinges share what they carry along their axes; what they carry in the plane is unique.
TEST_CASE("friction and requirements by unique reactions alone are not in doubt", "[runner][findings]") {
  const Json radial = {{"friction", {{"mu", 0.1}, {"radius", 0.01}}}};
  const Json axial = {{"friction", {{"mu", 0.1}, {"radius", 0.01}, {"axial_radius", 0.01}}}};
  CHECK(found_in_run(four_bar(radial), "--full").empty());
  CHECK(found_in_run(four_bar(axial)).empty());  // in its plane
  check_one(found_in_run(four_bar(axial), "--full"), {"by force 'B.friction' (joint B)"});
  CHECK(found_in_run(four_bar({{"friction", {{"mu", 0}, {"axial_radius", 0.01}, {"viscous_turn", 1}}}}), "--full")
            .empty());
  CHECK(found_in_run(four_bar({{"require", {{{"holds", "=abs(B.force_on_p_world_x) < 1 kN"}}}}}), "--full").empty());
  check_one(found_in_run(four_bar({{"require", {{{"holds", "=abs(C.torque_on_p_world_x) < 1 kN m"}}}}}), "--full"),
            {"requirement 'holds' (abs(C.torque_on_p_world_x) < 1 kN m)"});
}

TEST_CASE("a brake that an event puts into force later is in doubt, too", "[runner][findings]") {
  const std::string brake =
      R"("forces": [{"name": "brake", "type": "joint_friction", "link": "low", "mu": 0.1, "radius": 0.01, "active": false}],
         "events": [{"name": "pull", "at": 0.05, "activate": ["brake"]}], )";
  check_one(found_in_run(door(brake)), {"by force 'brake' (joint low)"});
}

TEST_CASE("shares of a joint that an event activates, and after a singular start, are in doubt, too",
          "[runner][findings]") {
  const std::string closes = R"("events": [{"name": "shut", "at": 0.05, "activate": ["high"]}], )";
  check_one(found_in_run(door(closes, kRubs, R"(, "active": false)")), {"by force 'low.friction' (joint low)"});
  const Called swept = call("sweep '" + door(closes, kRubs, R"(, "active": false)") + "' --vary run.until=0.08:0.1:2");
  CHECK(contains(swept.text, "by force 'low.friction' (joint low)"));
  CHECK(contains(swept.text, "(in 2 runs)"));

  std::ifstream in(std::string(paths::kSource) + "/tests/stability/scenes/change_point.json");
  Json scene = Json::parse(in);
  scene["joints"][1]["friction"] = {{"mu", 1e-3}, {"radius", 0.01}, {"axial_radius", 0.01}};
  scene["run"]["until"] = 0.1;
  const std::string file = kRunnerFolder + "/shared_after.json";
  std::ofstream(file) << scene;
  check_one(found_in_run(file, "--full"), {"by force 'B.friction' (joint B)"});
}

// There reactions have no value for an instant, which other findings say; no constraint is redundant.
TEST_CASE("friction of a mechanism that starts in a singular configuration depends on no share", "[runner][findings]") {
  std::ifstream in(defect_scene("start_in_change_point"));
  Json scene = Json::parse(in);
  scene["links"][0]["friction"] = {{"mu", 1e-3}, {"radius", "10 mm"}};
  const std::string file = kRunnerFolder + "/shared_change_point.json";
  std::ofstream(file) << scene;
  CHECK(found_in_run(file).empty());
}

}  // namespace shares_test
