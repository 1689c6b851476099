// SPDX-License-Identifier: BSD-3-Clause
// Couplings and the other joints of the catalogue in scenes: "pairs" by links and by objects, and what is refused at
// its place.
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"

namespace pairs_test {

using namespace lockstep;

namespace {

constexpr const char* kJoints =
    R"({"lockstep": 1, "bodies": [{"name": "one", "sphere": {"mass": 1, "radius": 0.1}},
  {"name": "two", "sphere": {"mass": 1, "radius": 0.1}}, {"name": "bead", "particle": 1, "position": [1, 0, 0]},
  {"name": "base", "fixed": true}],
  "markers": [{"name": "m1", "body": "one"}, {"name": "m2", "body": "two"}, {"name": "g", "body": "ground"}],
  "links": [{"name": "A", "type": "revolute", "p": "one", "s": "ground", "at": [0, 0, 0]},
  {"name": "B", "type": "revolute", "p": "two", "s": "ground", "at": [0, 0, 0]},
)";

// The sixth line of a scene, a link; "~" before the place that the message must name; words that it must have.
struct Bad {
  const char* line;
  std::vector<std::string> words;
};

const std::vector<Bad> kBad = {
    // pairs
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", ~"C"]})",
     {"joint 'G', pairs[1]", "unknown joint \"C\"", "a coupling comes after its joints"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": [~"G", "A"]})",
     {"joint 'G', pairs[0]", "unknown joint \"G\""}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ~"A"})", {"joint 'G'", "pairs", "a list of joint names"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ~[]})", {"joint 'G'", "pairs", "a list of joint names"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", ~3]})", {"joint 'G', pairs[1]", "number"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B"], "p": ~"one"})",
     {"joint 'G', p", "\"pairs\" is given as well", "remove one"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B"], "at": ~[0, 0, 0]})",
     {"joint 'G', at", "inside the pairs", "move it there"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", ~{"p": "two", "at": [0, 0, 0]}]})",
     {"joint 'G', pairs[1]", "missing key \"s\"", "both sides"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", {"p": "two", "s": "ground", "at": [0, 0, 0], ~"angle": 3}]})",
     {"joint 'G', pairs[1]", "unknown key \"angle\""}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", {"p": ~"tow", "s": "ground", "at": [0, 0, 0]}]})",
     {"joint 'G', pairs[1].p", "did you mean \"two\""}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", {"p": "two", "s": ~"two", "at": [0, 0, 0]}]})",
     {"joint 'G', pairs[1].s", "'two'", "both sides are on body"}},
    {R"(~{"name": "G", "type": "gear", "ratio": 2, "pairs": ["A"]})", {"'G'", "pair 2", "add it"}},
    {R"(~{"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B", "A"]})",
     {"joint 'G'", "takes 2 pairs", "3 are given"}},
    {R"(~{"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "A"]})",
     {"joint 'G'", "pairs 1 and 2", "the same two markers"}},
    {R"({"name": "G", "type": "revolute", "pairs": ~["A", "B"]})", {"joint 'G', pairs", "2 pairs are given", "has 1"}},
    {R"(~{"name": "G", "type": "gear", "ratio": 2})", {"joint 'G'", "\"pairs\" of a coupling"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B"], "drive": ~{"axis": "rz", "law": 1}})",
     {"joint 'G', drive", "type \"gear\" cannot have a drive"}},
    {R"({"name": "G", "type": "gear", "ratio": 2, "pairs": ["A", "B"], "start": {"velocity": {"rz": ~1}}})",
     {"joint 'G'", "type \"gear\" has no such coordinate"}},
    // keys of the types
    {R"({"name": "G", "type": "gear", "pairs": ["A", "B"], "ratio": ~0})", {"joint 'G', ratio", "is 0", "above zero"}},
    {R"({"name": "G", "type": "gear", "pairs": ["A", "B"], "ratio": ~2, "teeth_1": 20, "teeth_2": 40})",
     {"joint 'G', ratio", "the teeth are given", "remove"}},
    {R"({"name": "G", "type": "gear", "pairs": ["A", "B"], "teeth_1": ~0, "teeth_2": 40})",
     {"joint 'G', teeth_1", "is 0", "at least one"}},
    {R"({"name": "G", "type": "gear", "pairs": ["A", "B"], "ratio": 2, "mesh": ~"hypoid"})",
     {"joint 'G', mesh", "hypoid", "bevel"}},
    {R"({"name": "G", "type": "belt", "pairs": ["A", "B"], "radius_1": 1, "radius_2": ~-1})",
     {"joint 'G', radius_2", "is -1", "above zero"}},
    {R"({"name": "G", "type": "rack_and_pinion", "pairs": ["A", "B"], "radius": ~0})",
     {"joint 'G', radius", "is 0 m", "the radius of a pinion must not be zero"}},
    {R"({"name": "G", "type": "screw", "p": "m1", "s": "m2", "lead": ~"2 kg"})", {"joint 'G', lead", "a mass"}},
    {R"({"name": "G", "type": "cam_roller", "p": "m1", "s": "m2", "radius": 0.2, "roller": ~-0.1})",
     {"joint 'G', roller", "-0.1", "must not be negative"}},
    {R"({"name": "G", "type": "point_on_curve", "p": "bead", "s": "ground", "path": ~3})", {"joint 'G', path"}},
    {R"({"name": "G", "type": "universal", "p": "m1", "s": "m2", ~"axis_2": "x"})", {"unknown key \"axis_2\""}},
};

// Refused without a place of its own: keys that are missing.
const std::vector<Bad> kMissing = {
    {R"({"name": "G", "type": "gear", "pairs": ["A", "B"]})", {"ratio", "is missing", "teeth_1"}},
    {R"({"name": "G", "type": "gear", "pairs": ["A", "B"], "teeth_1": 20})", {"teeth_2", "is missing"}},
    {R"({"name": "G", "type": "belt", "pairs": ["A", "B"], "radius_1": 1})", {"missing key \"radius_2\""}},
    {R"({"name": "G", "type": "screw", "p": "m1", "s": "m2"})", {"missing key \"lead\""}},
    {R"({"name": "G", "type": "cam_flat", "p": "m1", "s": "m2"})", {"missing key \"radius\""}},
    {R"({"name": "G", "type": "path_follower", "p": "m1", "s": "m2", "path": {"type": "along", "axis": "x", "law": 1}})",
     {"missing key \"turning\""}},
};

std::string refusal_of(const std::string& link) {
  try {
    const Registry registry = builtin_registry();
    Mechanism m = build_mechanism(scene_from_text(kJoints + link + "]}", "bad.json"), registry);
    system_of(m).setup();
  } catch (const SceneError& error) {
    CHECK(error.line > 0);
    return error.what();
  } catch (const ModelError& error) {
    return error.what();
  }
  return "accepted";
}

void check_words(const std::string& message, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    INFO(message);
    INFO(word);
    CHECK(message.find(word) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("an impossible coupling is rejected at its place", "[unit][scene]") {
  for (const Bad& bad : kBad) {
    std::string line = bad.line;
    const std::size_t column = line.find('~') + 1;
    REQUIRE(column > 0);
    line.erase(column - 1, 1);
    const std::string message = refusal_of(line);
    INFO(message);
    CHECK(message.rfind("bad.json:7:" + std::to_string(column) + ": ", 0) == 0);
    check_words(message, bad.words);
  }
  for (const Bad& bad : kMissing) {
    const std::string message = refusal_of(bad.line);
    INFO(message);
    CHECK(message.rfind("bad.json:7:", 0) == 0);
    check_words(message, bad.words);
  }
}

TEST_CASE("a coupling takes joints by name, markers and bodies", "[unit][scene]") {
  const char* const pairs[] = {R"(["A", "B"])", R"([{"p": "m1", "s": "g"}, "B"])",
                               R"([{"p": "one", "s": "ground", "at": [0, 0, 0]}, {"p": "m2", "s": "g"}])"};
  for (const char* const text : pairs) {
    CAPTURE(text);
    const Registry registry = builtin_registry();
    Mechanism m = build_mechanism(
        scene_from_text(kJoints + std::string(R"({"name": "G", "type": "gear", "ratio": 2, "pairs": )") + text + "}]}",
                        "good.json"),
        registry);
    system_of(m).setup();
    const Lock& gear = m.system.link("G");
    REQUIRE(gear.pairs().size() == 2);
    CHECK(gear.pairs()[0].first->body->name == "one");
    CHECK(gear.pairs()[1].first->body->name == "two");
    CHECK(gear.pairs()[1].second->body->name == "ground");
    CHECK(gear.slots().n == 2);
    CHECK(gear.type() == "gear");
    CHECK(gear.origin() == "built in");
  }
}

TEST_CASE("an error that only appears in the mechanism names the joint", "[unit][scene]") {
  check_words(refusal_of(R"({"name": "G", "type": "universal", "p": "bead", "s": "ground"})"),
              {"joint 'G'", "'bead'", "particle"});
  check_words(refusal_of(R"({"name": "G", "type": "gear", "ratio": 2, "pairs": [{"p": "base", "s": "ground",
                             "at": [0, 0, 0]}, {"p": "base", "s": "ground", "at": [0, 0, 0]}]})"),
              {"joint 'G'", "none of the bodies", "can move"});
  check_words(refusal_of(R"({"name": "G", "type": "cam_roller", "p": "one", "s": "two", "at_p": [0.5, 0, 0],
                             "at_s": [0, 0, 0], "radius": {"type": "ramp", "y0": 0.2, "slope": 0.01}})"),
              {"joint 'G'", "does not close"});
}

}  // namespace pairs_test
