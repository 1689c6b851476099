// SPDX-License-Identifier: BSD-3-Clause
// What is wrong with several things of a scene is said at once.
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/refused_scene.h"

namespace scene_errors_together_test {

using namespace lockstep;
using lockstep::testing::refusal_of;

TEST_CASE("errors of the objects of a list are reported together", "[unit][scene]") {
  std::string scene = "{\"lockstep\": 1, \"bodies\": [";
  for (int i = 0; i < 3; ++i) scene += "{\"name\": \"b" + std::to_string(i) + "\", \"particle\": 1},\n";
  const std::string three = refusal_of(scene + R"({"name": "c", "particle": 0},
    {"name": "d", "particle": 1, "colour": 3}, {"name": "e", "particle": 1}, {"name": "f"}]})");
  CHECK(three.rfind("bad.json:4:", 0) == 0);  // the first comes first
  for (const char* word : {"body 'c'", "mass is 0", "\nbad.json:5:", "body 'd'", "\"colour\"", "body 'f'", "no mass"})
    CHECK(three.find(word) != std::string::npos);
  CHECK(three.find("body 'e'") == std::string::npos);
  for (int i = 0; i < 30; ++i) scene += "{\"name\": \"x" + std::to_string(i) + "\"},\n";
  const std::string many = refusal_of(scene + "{\"name\": \"last\"}]}");
  CHECK(std::count(many.begin(), many.end(), '\n') == 20);
  CHECK(many.find("more errors may follow") != std::string::npos);
}

TEST_CASE("errors of objects in several lists are reported together, except for consequences of other errors",
          "[unit][scene]") {
  const std::string message = refusal_of(R"({"lockstep": 1,
    "bodies": [{"name": "a", "particle": 0}, {"name": "b", "particle": 1, "velocit": [0,0,0], "positoin": [0,0,0]}, {"name": "c", "particle": 1, "velocity": [0,0], "position": 3}, {"name": "d", "particle": 1}],
    "markers": [{"name": "on_a", "body": "a", "at": [0,0,0]}, {"name": "on_d", "body": "d", "att": [0,0,0]}],
    "links": [{"name": "L", "type": "spherical", "p": "on_a", "s": "ground"}, {"name": "M", "type": "spherical", "p": "x", "s": "ground"}, {"name": "N", "type": "gear", "pairs": ["L", "M"], "ratio": 2}],
    "forces": [{"name": "f", "type": "applied_force", "p": "d", "at": [0,0,0], "forc": [0,0,1]}, {"name": "g", "type": "joint_friction", "link": "L", "coefficient": 0.1}],
    "events": [{"name": "e", "at": -1, "activate": ["M"]}, {"name": "h", "at": "1 m"}],
    "run": {"integrator": "rk5", "until": 1, "record": ["a.x"]}})");
  INFO(message);
  const std::vector<std::string> lines = [&] {
    std::vector<std::string> all;
    std::istringstream in(message);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }();
  const std::vector<std::vector<std::string>> wanted = {
      {"body 'a'", "mass is 0"}, {"body 'b'", "\"velocit\""}, {"body 'b'", "\"positoin\""},
      {"body 'c', position"},    {"body 'c', velocity"},      {"marker 'on_d'", "\"att\""},
      {"joint 'M', p", "\"x\""},  {"force 'f'", "\"forc\""},   {"force 'g'", "\"coefficient\""},
      {"event 'e', at", "-1"},   {"event 'h', at"},           {"run.integrator", "rk5"}};
  REQUIRE(lines.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    for (const std::string& word : wanted[i]) CHECK(lines[i].find(word) != std::string::npos);
}

namespace {

// A message has these lines and no others; each of them holds these words.
void check_lines(const std::string& message, const std::vector<std::vector<std::string>>& wanted) {
  INFO(message);
  std::istringstream in(message);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  REQUIRE(lines.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    for (const std::string& word : wanted[i]) {
      INFO(lines[i]);
      INFO(word);
      CHECK(lines[i].find(word) != std::string::npos);
    }
}

}  // namespace

TEST_CASE("errors of the settings of a run are reported together", "[unit][scene]") {
  check_lines(refusal_of(R"({"lockstep": 1, "gravitiy": 3, "requires": ["a/b", "c/d"], "run": {
    "integrator": 3, "solver": [1], "stabilization": {"alpha": -1, "beta": -2, "tolerance": 0},
    "step": 0, "until": -1, "output": "0 s", "times": [3, 2], "max_steps": 0, "tolerance": 0, "energy_limit": -1, "violation_limit": 0,
    "record": [3, "", {"u": 4}, "a.x", "a.x"], "draw": [["b"]], "pictures": [{"x": "b", "y": "c"}]}})"),
              {{"unknown key \"gravitiy\""},
               {"run.integrator", "expected a name"},
               {"run.solver", "expected a name"},
               {"alpha", "-1 1/s"},
               {"beta", "-2 1/s"},
               {"stabilization", "tolerance is 0"},
               {"run.step", "the step is 0"},
               {"run.until", "the end of the run is -1"},
               {"run.output", "the interval is 0"},
               {"run.times", "both define"},
               {"run.max_steps", "at least 1"},
               {"run.tolerance", "is 0"},
               {"run.energy_limit", "is -1"},
               {"run.violation_limit", "is 0"},
               {"run.record", "expected a channel's name"},
               {"run.record", "the name of a channel is empty"},
               {"run.record.u", "number"},
               {"run.record", "\"a.x\" is requested twice"}});
  // A key that is unknown or of a wrong form keeps the others from nothing; a name is looked for where all are known.
  check_lines(refusal_of(R"({"lockstep": 1, "run": {"untill": 3, "step": 0, "output": [2], "tolerance": -1,
    "record": ["a.x", {"u": "a.y"}], "draw": [["a.x", "v"], [], 3], "pictures": [{"x": "a.x", "y": "w"}, {"x": "z", "y": "u"}]}})"),
              {{"unknown key \"untill\"", "until"},
               {"run.output", "a list"},
               {"run.step", "the step is 0"},
               {"run.tolerance", "-1"},
               {"run.draw", "\"v\" is not recorded"},
               {"run.draw", "this panel is empty"},
               {"run.draw", "expected a panel"},
               {"run.pictures[0].y", "\"w\" is not recorded"},
               {"run.pictures[1].x", "\"z\" is not recorded"}});
  check_lines(refusal_of(R"({"lockstep": 1, "run": {"record": "a.x", "draw": [["b"]], "step": 0}})"),
              {{"run.step", "is 0"}, {"run.record", "expected a list of channels"}});
  check_lines(refusal_of(R"({"lockstep": 1, "run": 3})"), {{"run", "expected an object"}});
}

TEST_CASE("errors are in the order of their lines", "[unit][scene]") {
  check_lines(refusal_of("{\"lockstep\": 1, \"run\": {\"integrator\": \"rk5\"},\n"
                         "\"bodies\": [{\"name\": \"a\", \"particle\": 0}]}"),
              {{"bad.json:1:", "run.integrator"}, {"bad.json:2:", "body 'a'"}});
}

TEST_CASE("unknown channels are reported together, of a record and of events", "[unit][scene]") {
  const std::string body = R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1}], )";
  check_lines(refusal_of(body + R"("run": {"record": ["a.x", "a.xx", {"u": "b.x"}]}})"),
              {{"run.record", "a.xx"}, {"run.record", "b.x"}});
  check_lines(refusal_of(body + R"("events": [{"name": "e", "stop": true, "when": {"channel": "b.x"}},
    {"name": "f", "stop": true, "when": {"channel": "a.x", "crosses": "3 kg"}},
    {"name": "g", "stop": true, "when": {"channel": "a.xx"}}]})"),
              {{"event 'e', when.channel", "b"}, {"event 'f', when.crosses", "in m"}, {"event 'g'", "a.xx"}});
}

TEST_CASE("a name that may be that of a thing with a wrong name is not called unknown", "[unit][scene]") {
  check_lines(refusal_of(R"({"lockstep": 1,
    "bodies": [{"name": "coupler", "particle": 1}, {"name": "coupler", "particle": 1}],
    "links": [{"name": "D", "type": "spherical", "p": "rocker", "s": "ground", "at": [0, 0, 0]}],
    "run": {"record": ["rocker.x", "D.x"]}})"),
              {{"body 'coupler'", "already taken"}});
}

TEST_CASE("formulas that cannot be computed are reported together, each reason once", "[unit][scene]") {
  check_lines(refusal_of(R"({"lockstep": 1, "parameters": {"a": "=b", "b": "=a", "c": "=1 +", "d": "=2*c", "e": 2},
    "points": {"P": ["=e*nothing", 0, 0], "Q": [1, 2, 3]},
    "bodies": [{"name": "x", "particle": "=d"}, {"name": "y", "particle": "=e*f", "position": "R"},
               {"name": "z", "particle": "=sqrt(", "position": "P"}]})"),
              {{"parameters.a", "depends on itself: a -> b -> a"},
               {"parameters.c", "=1 +"},
               {"points.P[0]", "nothing"},
               {"body 'y'", "position", "unknown point \"R\""},
               {"body 'y', particle", "\"f\""},
               {"body 'z', particle"}});
}

TEST_CASE("each of several errors names its formula", "[unit][scene]") {
  check_lines(
      refusal_of(
          R"({"lockstep": 1, "parameters": {"n": 2}, "run": {"step": "=n - 2", "tolerance": 0, "until": "=-n"}})"),
      {{"run.step", "is 0", "the value is from the formula \"=n - 2\""},
       {"run.until", "-2", "the value is from the formula \"=-n\""},
       {"run.tolerance", "is 0; it must be greater than 0"}});
}

TEST_CASE("a scene of a newer format is rejected for that alone", "[unit][scene]") {
  check_lines(refusal_of(R"({"lockstep": 2, "of_then": 3, "bodies": 4, "run": {"step": 0}})"),
              {{"lockstep", "version 2 of the format is unknown", "reads version 1"}});
}

TEST_CASE("of a thing whose type is missing its own keys are not called unknown", "[unit][scene]") {
  const auto said_of = [](const std::string& keys) {
    return refusal_of(R"({"lockstep": 1, "bodies": [{"name": "a", "particle": 1}],
      "forces": [{"name": "f", )" +
                      keys + R"(, "p": "a", "s": "ground", "stiffness": 5}]})");
  };
  for (const char* keys : {R"("typ": "spring_damper")", R"("damping": 3, "typ": "spring_damper")"}) {
    const std::string message = said_of(keys);
    INFO(message);
    CHECK(message.find("\"typ\"; did you mean \"type\"") != std::string::npos);
    CHECK(message.find('\n') == std::string::npos);
  }
  const std::string message = said_of(R"("damping": 3)");
  INFO(message);
  CHECK(message.find("force 'f': missing key \"type\"") != std::string::npos);
  CHECK(message.find('\n') == std::string::npos);
}

TEST_CASE("a part of a compound is not advised to be a particle", "[unit][scene]") {
  const std::string message = refusal_of(R"({"lockstep": 1, "bodies": [{"name": "a", "compound": [{"mass": 1}]}]})");
  CHECK(message.find("body 'a', compound[0].mass: a part needs an inertia") != std::string::npos);
  CHECK(message.find("particle") == std::string::npos);
}

}  // namespace scene_errors_together_test
