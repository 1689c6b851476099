// Every kind of finding is provoked once, and stands in the JSON of the command that makes it.
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include <lockstep/finding.h>
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
      {"constraints-drifted", kRun,
       kFalling + R"(, "run": {"integrator": "rk4", "step": 0.1, "until": 20, "formulation": "omega",
         "stabilization": "none", "violation_limit": "1 um"})"},
      {"violated-in-run", kRun,
       kFalling + R"(, "run": {"integrator": "rk4", "step": 0.1, "until": 20, "formulation": "omega",
         "stabilization": "none", "violation_limit": "1 um"})"},
      {"tolerance-not-reached", "run '" + std::string(paths::kScenes) +
                                    "/nfourbar_40.json' --tolerance 1e-13 --until 2 --no-picture --record found.csv --json"},
      {"singular-position-passed", "run " + own_scene("slider_crank_equal_arms") +
                                       " --integrator rk4 --step 1e-3 --until 0.3 --no-picture --record found.csv --json"},
      {"reactions-uncertain", "run " + defect_scene("start_in_change_point") + " --no-picture --record found.csv --json"},
      {"singular-start", "run " + defect_scene("start_in_change_point") + " --no-picture --record found.csv --json"},
      {"not-certified", kRun + " --certify --budget 10s",
       kFalling + R"(, "run": {"integrator": "dopri5", "tolerance": 10, "until": 20, "output": 0.1, "record": ["arm.vx"]})"},
      {"start-far", "assemble @ --within 1mm --json",
       R"("bodies": [{"name": "arm", "position": [0.1, 0, 0], "mass": 1, "inertia": [1, 1, 1]}], "links": [{)" + kHinge +
           R"(, "at_p": [0, 0, 0], "at_s": [0, 0, 0], "assembled": "free"}])"},
      {"start-moved", "assemble @ --json",
       R"("bodies": [{"name": "arm", "position": [5, 0, 0], "mass": 1, "inertia": [1, 1, 1]}],
          "links": [{"name": "A", "type": "spherical", "p": "arm", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0]}])"},
      {"renamed-key", kRun,
       kArm + R"("markers": [{"name": "K", "body": "ground", "slide": {"type": "constant", "value": [0, 0, 0]}}],
          "links": [{)" + kHinge + "}]" + until + R"("record": ["arm.x"]})"},
      {"quaternion-length", kRun,
       R"("bodies": [{"name": "top", "mass": 1, "inertia": [1, 1, 1], "orientation": [1, 1, 0, 0]}])" + until +
           R"("record": ["top.x"]})"},
      {"negative-stiffness", kRun,
       R"("bodies": [{"name": "bob", "particle": 1, "position": [1, 0, 0]}], "forces": [{"name": "F",
          "type": "spring_damper", "p": "bob", "s": "ground", "at_p": [0, 0, 0], "at_s": [0, 0, 0], "stiffness": -1,
          "length": 0.5}])" + until + R"("record": ["bob.x"]})"},
      {"outputs-beyond-end", kRun, kFalling + R"(, "run": {"until": 1, "times": [0, 0.5, 2], "record": ["arm.x"]})"},
      {"setting-unused", kRun,
       kFalling + until + R"("integrator": "rk4", "step": 0.01, "tolerance": 1e-6, "record": ["arm.x"]})"},
      {"length-repeated", "sweep @ --vary bodies.arm.rod.to.0=1,2 --record found.csv --json",
       kArm + R"("links": [{)" + kHinge + R"(}], "forces": [{"name": "F", "type": "spring_damper", "p": "arm",
         "s": "ground", "at_p": [0, 0, 0], "at_s": [1, 0, 0], "stiffness": 1, "length": 0.5}])" +
           until + R"("record": ["arm.x"]})"},
      {"start-speed-lost", kRun,
       R"("bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}, "velocity": [5, 0, 0]}],
          "links": [{)" + kHinge + "}]" + until + R"("record": ["arm.x"]})"},
      {"no-freedom", kRun,
       kArm + R"("links": [{)" + kHinge + R"(}, {"name": "B", "type": "spherical", "p": "arm", "s": "ground",
          "at": [1, 0, 0]}])" + until + R"("record": ["arm.x"]})"},
      {"long-turn", kRun,
       R"("bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "omega_world": [0, 0, 50]}])" + until +
           R"("integrator": "rk4", "step": 0.1, "record": ["b.x"]})"},
      {"long-steps", kRun,
       kFalling + R"(, "run": {"until": 1, "output": 0.01, "integrator": "semi_implicit_euler", "step": 0.1,
         "record": ["arm.x"]})"},
      {"event-at-zero", kRun,
       kFalling + R"(, "events": [{"name": "low", "when": {"channel": "arm.y", "crosses": 1, "direction": "falling"},
         "stop": true}])" + until + R"("record": ["arm.x"]})"},
      {"event-missed", kRun,
       kFalling + R"(, "events": [{"name": "late", "at": 7, "stop": true}])" + until + R"("record": ["arm.x"]})"},
      {"energy-suspect", "run @ --plugin '" + kModules + "/naughty.so' --record found.csv --no-picture --json",
       R"("gravity": [0, 0, 0], "bodies": [{"name": "arm", "particle": 1, "position": [1, 0, 0]}],
          "forces": [{"name": "F", "type": "naughty_force", "p": "arm", "at": [0, 0, 0], "does": "half a potential"}],
          "run": {"until": 1, "output": 0.1, "record": ["arm.x"]})"},
      {"stiff", kRun,
       R"("gravity": [0, 0, 0], "bodies": [{"name": "bob", "particle": 1, "position": [1, 0, 0]}],
          "forces": [{"name": "F", "type": "spring_damper", "p": "bob", "s": "ground", "at_p": [0, 0, 0],
          "at_s": [0, 0, 0], "stiffness": 1, "damping": 1e5, "length": 0.5}],
          "run": {"until": 5, "output": 0.5, "record": ["bob.x"]})"},
      {"analysis-note", "statics @ --json", kFalling},
  };
}

std::set<std::string> codes_in(const Json& result) {
  std::set<std::string> codes;
  for (const Json& f : result["findings"]) codes.insert(f["code"].get<std::string>());
  return codes;
}

}  // namespace

TEST_CASE("every kind of finding is provoked, and JSON has it", "[runner][findings]") {
  for (const Provoked& each : all()) {
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
}

}  // namespace findings_test
