// SPDX-License-Identifier: BSD-3-Clause
// Parameters of a scene from the command line: run, check, sweep.
#include <algorithm>
#include <cmath>

#include <lockstep/recorder.h>
#include <lockstep/splines.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/program.h"
#include "tests/support/run_scene.h"

namespace parameters_command_test {

using namespace lockstep;
using namespace lockstep::testing;

TEST_CASE("the option --set gives a parameter another value, and all dependent values follow", "[runner]") {
  const std::string scene = scene_path("slider_crank");
  for (const auto& [crank, most] : {std::pair{"100 mm", 0.45}, {"120 mm", 0.47}}) {
    const Called ran = call("run " + scene + " --quiet --record set.csv --set crank=\"" + crank + "\"");
    INFO(ran.text);
    REQUIRE(ran.exit == 0);
    const Table table = read_csv(kRunnerFolder + "/set.csv");
    const auto& x = table["xs"];
    CHECK(std::abs(x.front() - most) < 1e-9);                                      // crank + rod, stretched
    CHECK(std::abs(*std::min_element(x.begin(), x.end()) - (0.7 - most)) < 1e-5);  // rod - crank, half a turn later
  }
  check_words(call("run " + scene + " --set crnk=1").text, {"--set", "\"crnk\"", "did you mean \"crank\""});
  check_refused(call("run " + scene + " --set crank=\"1 kg\""), 2, {"--set", "m is expected"});
  check_words(call("run " + scene + " --set crank=\"-1 kg/0\"").text, {"--set"});
  check_words(call("check " + scene + " --set crank=0").text, {"both ends are at the same point"});
}

TEST_CASE("the option --set gives vectors and axes another value as a whole", "[runner]") {
  const std::string run = "run " + scene_path("four_bar") + " --quiet --record whole.csv --set ";
  const auto torque_with = [&](const std::string& setting) {
    const Called ran = call(run + setting);
    INFO(ran.text);
    REQUIRE(ran.exit == 0);
    return read_csv(kRunnerFolder + "/whole.csv")["drive_torque"];
  };
  const std::vector<double> parts = torque_with("gravity.0=1 --set gravity.1=9.81");
  CHECK(torque_with("\"gravity=[1, 9.81, 0]\"") == parts);
  CHECK(torque_with("\"gravity=[1 m/s^2, 9.81 m/s^2, 0]\" --set joints.B.axis=z") == parts);
  check_refused(call(run + "gravity=5"), 3, {"gravity: expected a list of 3 numbers, got a number (5)"});
  check_refused(call(run + "gravity=[0,9.81]"), 3, {"gravity", "a list of 2"});
  check_refused(call(run + "joints.B.axis=w"), 3, {"axis", "\"w\""});
}

TEST_CASE("check lists parameters and points with their values", "[runner]") {
  const Called text = call("check " + scene_path("four_bar") + " --verbose --set crank=120mm");
  INFO(text.text);
  CHECK(text.exit == 0);
  check_words(text.text,
              {"parameters", "crank", "0.12 m", "beta", "=atan2(BD.y, BD.x)", "points:", "=A + [base, 0, 0]"});
  const Called json = call("check " + scene_path("four_bar") + " --json");
  check_words(json.text, {"\"parameters\"", "\"name\": \"coupler\"", "\"value\": \"0.3 m\"", "\"kind\": \"point\""});
  CHECK_FALSE(contains(call("check " + scene_path("screw") + " --verbose").text, "parameters"));
}

TEST_CASE("a sweep varies a parameter: other lengths give other motions", "[runner]") {
  const Called swept =
      call("sweep " + scene_path("slider_crank") + " --vary crank=\"100 mm:200 mm:3\" --record lengths.csv --quiet");
  INFO(swept.text);
  REQUIRE(swept.exit == 0);
  CHECK_FALSE(contains(swept.text, "also given"));
  const Columns table = read_columns(kRunnerFolder + "/lengths.csv", "run", {"crank", "xs max", "xs min"});
  REQUIRE(table.t.size() == 3);
  for (int i = 0; i < 3; ++i) {
    const double crank = 0.1 + 0.05 * i;
    CHECK(std::abs(table.y(i, 0) - crank) < 1e-15);
    CHECK(std::abs(table.y(i, 1) - (crank + 0.35)) < 1e-8);
    CHECK(std::abs(table.y(i, 2) - (0.35 - crank)) < 1e-4);
  }
}

TEST_CASE("a length that varies while it stands elsewhere is warned about", "[runner]") {
  const std::string scene =
      scene_file("twice", R"("bodies": [{"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.3, 0, 0]}},
                             {"name": "b", "rod": {"mass": 1, "from": [0.3, 0, 0], "to": [0.9, 0, 0]}}],
                  "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0, 0, 0]},
                            {"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [0.3, 0, 0]}],
                  "gravity": [0, -9.81, 0], "run": {"until": 0.01, "output": 0.01, "record": ["b.x"]})");
  check_words(call("sweep " + scene + " --vary bodies.a.rod.to.0=0.3,0.4 --record twice.csv").text,
              {"the length at bodies.a.rod.to.0 is also given at bodies.b.rod.from.0 and joints.B.at.0, "
               "which do not vary with it",
               "make it a parameter and write \"=name\" in these places"});
  CHECK_FALSE(
      contains(call("sweep " + scene + " --vary bodies.a.rod.mass=1,2 --record twice.csv").text, "also given"));
}

}  // namespace parameters_command_test
