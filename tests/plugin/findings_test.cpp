// SPDX-License-Identifier: BSD-3-Clause
// Every kind of finding is provoked once, and stands in the JSON of the command that makes it.
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include <lockstep/finding.h>
#include "framework/mechanism/expression/function.h"
#include "tests/support/catch.h"
#include "tests/support/open_defect.h"
#include "tests/support/paths.h"
#include "tests/support/plugin_files.h"
#include "tests/support/program.h"

namespace findings_test {

using namespace lockstep;
using namespace lockstep::testing;
using Json = nlohmann::ordered_json;

namespace {

const std::string kFalling = kArm + R"("gravity": [0, -9.81, 0], "links": [{)" + kHinge + "}]";

// A bob on a spring.
std::string spring(const std::string& members) {
  return R"("gravity": [0, 0, 0], "bodies": [{"name": "bob", "particle": 1, "position": [1, 0, 0]}],
    "forces": [{"name": "F", "type": "spring_damper", "p": "bob", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0],
    "free_length": 0.5, )" +
         members + "}]";
}

// Driven by a table without units, bare.csv.
const std::string kBare =
    kArm + R"("links": [{)" + kHinge + R"(, "drive": {"axis": "rz", "law": {"type": "spline", "file": "bare.csv"}}}])";

// Driven by a table whose columns are named after their units.
const std::string kNamed = kArm + R"("links": [{)" + kHinge +
                           R"~(, "drive": {"axis": "rz", "law": {"type": "spline", "file": "named.csv",
                              "t_column": "time_ms", "y_column": "angle (deg)"}}}])~";

const char* const kNamedTable = "time_ms,angle (deg)\n0,0\n2,1\n";

/// A command whose JSON has the finding.
struct Provoked {
  const char* code;
  std::string words, scene{};  ///< the words of a command; members of a scene, whose file stands for @
};

std::string own_scene(const std::string& name) {
  return "'" + std::string(paths::kSource) + "/tests/verification/scenes/" + name + ".json'";
}

const std::string kRun = "run @ --record found.csv --no-picture --json";

std::vector<Provoked> all() {
  const std::string until = R"(, "run": {"until": 1, "output": 0.1, )";
  return {
      {"energy-not-conserved", kRun,
       kFalling + R"(, "run": {"integrator": "dopri5", "tolerance": 10, "until": 20, "output": 0.1})"},
      {"requirement-broken", kRun,
       kFalling + R"(, "require": [{"up": "=A.rz > -30 deg"}])" + until + R"("record": ["arm.x"]})"},
      {"constraints-drifted", kRun,
       kFalling + R"(, "run": {"integrator": "rk4", "step": 0.1, "until": 20, "formulation": "omega",
         "stabilization": "none", "violation_limit": "1 um"})"},
      {"violated-in-run", kRun,
       kFalling + R"(, "run": {"integrator": "rk4", "step": 0.1, "until": 20, "formulation": "omega",
         "stabilization": "none", "violation_limit": "1 um"})"},
      {"tolerance-not-reached",
       "run '" + std::string(paths::kScenes) +
           "/nfourbar_40.json' --tolerance 1e-13 --until 2 --no-picture --record found.csv --json"},
      {"singular-position-passed",
       "run " + own_scene("slider_crank_equal_arms") +
           " --integrator rk4 --step 1e-3 --until 0.3 --no-picture --record found.csv --json"},
      {"reactions-uncertain",
       "run " + defect_scene("start_in_change_point") + " --no-picture --record found.csv --json"},
      {"singular-start", "run " + defect_scene("start_in_change_point") + " --no-picture --record found.csv --json"},

      {"start-far", "assemble @ --within 1mm --json",
       R"("bodies": [{"name": "arm", "position": [5, 0, 0], "mass": 1, "inertia": [1, 1, 1]}],
          "links": [{"name": "A", "type": "spherical", "p": "arm", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0]}])"},
      {"start-moved", "assemble @ --json",
       R"("bodies": [{"name": "arm", "position": [5, 0, 0], "mass": 1, "inertia": [1, 1, 1]}],
          "links": [{"name": "A", "type": "spherical", "p": "arm", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0]}])"},
      {"quaternion-length", kRun,
       R"("bodies": [{"name": "top", "sphere": {"mass": 1, "radius": 1}, "orientation": [0.74, 0.74, 0, 0]}])" + until +
           R"("record": ["top.x"]})"},
      {"implausible", kRun,
       kArm + R"("gravity": [0, -9810, 0], "links": [{)" + kHinge + "}]" + until + R"("record": ["arm.x"]})"},
      {"negative-stiffness", kRun, spring(R"("stiffness": -1)") + until + R"("record": ["bob.x"]})"},
      {"outputs-beyond-end", kRun, kFalling + R"(, "run": {"until": 1, "times": [0, 0.5, 2], "record": ["arm.x"]})"},
      {"setting-unused", kRun,
       kFalling + until + R"("integrator": "rk4", "step": 0.01, "tolerance": 1e-6, "record": ["arm.x"]})"},
      {"length-repeated", "sweep @ --vary bodies.a.rod.to.0=0.3,0.4 --record found.csv --json",
       R"("bodies": [{"name": "a", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0.3, 0, 0]}}],
          "links": [{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [0.3, 0, 0]}])" +
           until + R"("record": ["a.x"]})"},
      {"units-ignored", kRun, kNamed + until + R"("record": ["arm.x"]})"},
      {"units-assumed", kRun, kBare + until + R"("record": ["arm.x"]})"},
      {"start-speed-lost", kRun,
       R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}, "velocity": [5, 0, 0]}],
          "links": [{)" +
           kHinge + "}]" + until + R"("record": ["arm.x"]})"},
      {"start-changed", kRun,
       R"("bodies": [{"name": "base", "sphere": {"mass": 1, "radius": 0.1}, "velocity": [0, 0, 0]}, {"name": "arm",
                      "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
          "links": [{"name": "A", "type": "revolute", "p": "arm", "s": "base", "at": [0, 0, 0],
                     "start": {"velocity": {"rz": 1}}}])" +
           until + R"("record": ["arm.x"]})"},
      {"inertia-lost", kRun,
       R"("bodies": [{"name": "arm", "mass": 1, "inertia": [1e-12, 0.1, 0.1], "position": [0.5, 0, 0]}],
          "links": [{"name": "A", "type": "universal", "p": "arm", "s": "ground", "at": [0, 0, 0]}])" +
           until + R"("record": ["arm.x"]})"},
      {"no-freedom", kRun,
       kArm + R"("links": [{)" + kHinge + R"(}, {"name": "B", "type": "spherical", "p": "arm", "s": "ground",
          "at": [1, 0, 0]}])" +
           until + R"("record": ["arm.x"]})"},
      {"long-turn", kRun,
       R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "omega_world": [0, 0, 50]}])" + until +
           R"("integrator": "rk4", "step": 0.1, "record": ["b.x"]})"},
      {"long-steps", kRun,
       kFalling + R"(, "run": {"until": 1, "output": 0.01, "integrator": "semi_implicit_euler", "step": 0.1,
         "record": ["arm.x"]})"},
      {"event-at-zero", kRun,
       kFalling + R"(, "events": [{"name": "low", "when": {"channel": "arm.y", "crosses": 1, "direction": "falling"},
         "stop": true}])" +
           until + R"("record": ["arm.x"]})"},
      {"stop-passed", "kinematics @ --record found.csv --json",
       kArm + R"("links": [{)" + kHinge +
           R"(, "drive": {"axis": "rz", "law": {"type": "ramp", "slope": 1}}, "stops": [{"axis": "rz", "high": 0.5}]}])" +
           until + R"("record": ["A.rz"]})"},
      {"friction-damps", "modes @ --json",
       R"("gravity": [0, -9.81, 0], "bodies": [{"name": "block", "mass": 2, "inertia": [1, 1, 1]}],
          "links": [{"name": "rail", "type": "prismatic", "p": "block", "s": "ground", "at": [0, 0, 0], "axis": "x",
                     "friction": {"mu": 0.1}}])"},
      {"event-missed", kRun,
       kFalling + R"(, "events": [{"name": "late", "at": 7, "stop": true}])" + until + R"("record": ["arm.x"]})"},
      {"energy-suspect", "run @ --plugin '" + kModules + "/naughty.so' --record found.csv --no-picture --json",
       R"("gravity": [0, 0, 0], "bodies": [{"name": "arm", "particle": 1, "position": [1, 0, 0]}],
          "forces": [{"name": "F", "type": "naughty_force", "p": "arm", "at": [0, 0, 0], "does": "half a potential"}],
          "run": {"until": 1, "output": 0.1, "record": ["arm.x"]})"},
      {"stiff", kRun,
       spring(R"("stiffness": 1e5, "damping": 1e4)") + R"(, "run": {"until": 5, "output": 0.5, "record": ["bob.x"]})"},
      {"analysis-note", "modes @ --frozen --json", kFalling},
      {"held-turn", kRun,
       R"("bodies": [{"name": "one", "sphere": {"mass": 1, "radius": 0.1}},
          {"name": "two", "sphere": {"mass": 1, "radius": 0.1}, "position": [1, 0, 0]}],
          "links": [{"name": "A", "type": "revolute", "p": "one", "s": "ground", "at": [0, 0, 0]},
          {"name": "B", "type": "prismatic", "p": "two", "s": "ground", "at": [1, 0, 0]},
          {"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B"]}])" +
           until + R"("record": ["one.x"]})"},
      {"not-included", kRun,
       R"("include": [{"scene": "part.json", "prefix": "a_"}])" + until + R"("record": ["a_arm.x"]})"},
      {"start-missed", "assemble @ --json",
       R"("bodies": [{"name": "slider", "mass": 2, "inertia": [1, 1, 1], "position": [0, 0, 0]}],
          "links": [{"name": "G", "type": "prismatic", "p": "slider", "s": "ground", "at_p": [0, 0, 0],
          "at_s": [0, 0, 0], "axis": "x", "start": {"near": {"z": "30 cm"}}}])"},
      {"turns-uncertain", kRun,
       R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "omega_world": [4, 0, 0]}])" + until +
           R"("integrator": "rk4", "step": 0.01, "record": ["b.angle_y"]})"},
      {"energy-not-judged", "run @ --plugin '" + kModules + "/naughty.so' --record found.csv --no-picture --json",
       R"("gravity": [0, 0, 0], "bodies": [{"name": "arm", "particle": 1, "position": [1, 0, 0]}],
          "forces": [{"name": "F", "type": "naughty_force", "p": "arm", "at": [0, 0, 0], "does": "no potential"}],
          "run": {"until": 1, "output": 0.1, "record": ["arm.x"]})"},
      {"reactions-not-unique", kRun,
       R"("bodies": [{"name": "door", "mass": 2, "inertia": [0.1, 0.2, 0.25], "position": [0.5, 0, 0]}],
          "links": [{"name": "A", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0]},
          {"name": "B", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 1]}])" +
           until + R"("record": ["A.force_on_p_world_x"]})"},
      {"depends-on-share", kRun,
       R"("gravity": [0, 0, -9.81],
          "bodies": [{"name": "door", "mass": 2, "inertia": [0.1, 0.2, 0.25], "position": [0.5, 0, 0]}],
          "links": [{"name": "A", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 0],
                     "friction": {"mu": 0.1, "radius": "10 mm"}},
          {"name": "B", "type": "revolute", "p": "door", "s": "ground", "at": [0, 0, 1]}])" +
           until + R"("record": ["door.x"]})"},
      {"nearly-redundant", kRun,
       R"("gravity": [0, 0, 0], "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
          "links": [{"name": "A", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x"},
          {"name": "B", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": [1, 5e-4, 0]}])" +
           until + R"("record": ["b.x"]})"},
  };
}

std::set<std::string> codes_in(const Json& result) {
  std::set<std::string> codes;
  for (const Json& f : result["findings"]) codes.insert(f["code"].get<std::string>());
  return codes;
}

}  // namespace

TEST_CASE("every kind of finding is provoked, and JSON has it", "[runner][findings]") {
  scene_file("part", kFalling);
  std::ofstream(kRunnerFolder + "/bare.csv") << "t,y\n0,0\n1,1\n";
  std::ofstream(kRunnerFolder + "/named.csv") << kNamedTable;
  // Of formulas, and of a run whose JSON --certify excludes.
  std::set<std::string_view> provoked{"switches-unresolved", "not-certified"};
  for (const Provoked& each : all()) {
    provoked.insert(each.code);
    DYNAMIC_SECTION(each.code) {
      std::string words = each.words;
      if (const std::size_t at = words.find('@'); at != std::string::npos)
        words.replace(at, 1, "'" + scene_file("found", each.scene) + "'");
      const Called r = shell("lockstep " + words + " 2>/dev/null");
      INFO(words << '\n' << r.text);
      const Json result = Json::parse(r.text);
      CHECK(codes_in(result).contains(each.code));
      for (const Json& f : result["findings"])
        if (f["code"] == each.code) CHECK(f["severity"] == to_string(finding_kind(each.code).severity));
    }
  }
  for (const FindingKind* kind : finding_kinds()) {
    INFO(kind->code);
    CHECK(provoked.contains(kind->code));
  }
}

TEST_CASE("an angle in doubt is reported once, although the picture computes it again", "[runner][findings]") {
  const std::string text =
      call("run " + sample("pendulum") + " --integrator generalized_alpha:rho_infinity=1 --step 0.3 --record '" +
           kRunnerFolder + "/doubt.csv'")
          .text;
  INFO(text);
  CHECK(contains(text, "turns-uncertain"));
  CHECK(text.find("turns-uncertain") == text.rfind("turns-uncertain"));
}

TEST_CASE("a table without units is noted once, with the header to write", "[runner][findings]") {
  const std::string scene = scene_file("bare", kBare + R"(, "run": {"until": 1, "record": ["arm.x"]})");
  const auto notes = [&](const std::string& header) {
    std::ofstream(kRunnerFolder + "/bare.csv") << header << "\n0,0\n1,1\n";
    const std::string text = call("run '" + scene + "' --no-picture").text, note = "note      units-assumed: ";
    INFO(text);
    CHECK(text.find(note) == text.rfind(note));
    const std::size_t at = text.find(note);
    return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
  };
  CHECK(notes("t [s],y [rad]").empty());
  CHECK(contains(notes("t [s],y"),
                 "bare.csv: the first line has no unit for y, so SI is assumed; write units in "
                 "brackets, as in \"time [ms],torque [N mm]\""));
  CHECK(contains(notes("t,y"), "no unit for t and y"));
}

TEST_CASE("a unit in the name of a column is a doubt, and an error with --strict", "[runner][findings]") {
  std::ofstream(kRunnerFolder + "/named.csv") << kNamedTable;
  const std::string scene = scene_file("named_run", kNamed + R"(, "run": {"until": 1, "record": ["arm.x"]})");
  const Called said = call("run '" + scene + "' --no-picture");
  INFO(said.text);
  CHECK(said.exit == 0);
  CHECK(contains(said.text,
                 "named.csv: column 'time_ms' is read in SI, although its name ends in \"ms\"; write the unit in "
                 "brackets: \"time [ms]\""));
  CHECK(contains(said.text, "\"angle [deg]\""));
  CHECK(contains(said.text, "DOUBT     units-ignored: "));
  CHECK(call("run '" + scene + "' --no-picture --strict").exit == 11);
  CHECK(
      contains(call("sweep '" + scene + "' --vary run.until=0.5,1 --record named_sweep.csv").text, "units-ignored: "));
}

// Steps of half a second, in which the arm turns by more than two radians.
TEST_CASE("a run without a verified digit ends with the exit code of a doubtful one", "[runner][findings]") {
  const std::string scene = scene_file("uncertified", kFalling + R"(, "run": {"integrator": "rk4", "step": 0.5,
    "until": 20, "output": 0.5, "energy_limit": 100, "record": ["arm.vx"]})");
  check_refused(call("run '" + scene + "' --certify --budget 10s --no-picture --record found.csv"), 11,
                {"--certify: no digit of arm.vx is verified"});
}

// (t + 1)^2 - t^2 - 2 t - 1 is zero but for rounding, which changes its sign all along.
TEST_CASE("comparisons of a formula that are equal over a span are found", "[unit][findings]") {
  const FindingScope scope;
  const expression::FormulaFunction f("abs((t + 1)^2 - t^2 - 2*t - 1)", {"t"}, {});
  std::vector<double> switches;
  f.breakpoints(0, 0, 3, switches);
  REQUIRE(scope.found.size() == 1);
  CHECK(scope.found.front().code() == "switches-unresolved");
}

}  // namespace findings_test
