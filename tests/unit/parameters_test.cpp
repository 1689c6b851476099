// SPDX-License-Identifier: BSD-3-Clause
// Parameters, points and formulas in scenes.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include <lockstep/author/passes.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/laws.h>
#include <lockstep/scene.h>
#include "framework/description/scene/json.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/scene_folder.h"

namespace parameters_test {

using namespace lockstep;
using lockstep::testing::builtin;
using lockstep::testing::check_words;
using lockstep::testing::message_of;

namespace {

Scene scene_of(const std::string& members) { return scene_from_text("{\"lockstep\": 1, " + members + "}", "s.json"); }
Mechanism built(const std::string& members) { return build_mechanism(scene_of(members), builtin()); }
std::string refusal(const std::string& members) {
  return message_of<SceneError>([&] { built(members); });
}

// A crank and a rod whose lengths stand once.
const std::string kNames = R"("parameters": {"crank": "150 mm", "rod": "=2*crank", "phi": "30 deg"},
  "points": {"A": [0, 0, 0], "B": "=A + crank*[cos(phi), sin(phi), 0]", "C": "=B + [rod, 0, 0]"}, )";
const std::string kScene = kNames + R"~(
  "bodies": [{"name": "crank", "rod": {"mass": 1, "from": "A", "to": "B"}},
             {"name": "rod", "rod": {"mass": "=2 kg", "from": "B", "to": "C"}},
             {"name": "slider", "box": {"mass": 3, "size": ["=crank/5", 0.04, 0.04]}, "position": "C"}],
  "markers": [{"name": "eye", "body": "rod", "at": "C"}, {"name": "middle", "body": "rod", "at": ["=rod/10", 0, 0]}],
  "links": [{"name": "JA", "type": "revolute", "p": "crank", "s": "ground", "at": "A",
             "drive": {"axis": "rz", "law": {"type": "ramp", "slope": "=2*pi*1 rad/(500 ms)"
}
}
},
            {"name": "JB", "type": "revolute", "p": "rod", "s": "crank", "at": "B"},
            {"name": "JC", "type": "revolute", "p": "slider", "s": "eye"},
            {"name": "guide", "type": "lock", "mask": "z e1 e2 e3", "p": "slider", "s": "ground", "at_p": "C", "at_s": "C"}],
  "run": {"until": "=3*200 ms", "output": 0.1})~";

}  // namespace

TEST_CASE("a length given once places all its dependents", "[unit][scene]") {
  for (const double crank : {0.15, 0.2}) {
    const Scene scene = crank == 0.15 ? scene_of(kScene) : set_in_scene(scene_of(kScene), {"crank=200 mm"}, builtin());
    const Mechanism m = build_mechanism(scene, builtin());
    const double rod = 2 * crank, c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    const Vec3 B(crank * c, crank * s, 0), C(crank * c + rod, crank * s, 0);
    CHECK((m.system.body("crank").home.x - 0.5 * B).norm() < 1e-15);
    CHECK((m.system.body("rod").home.x - 0.5 * (B + C)).norm() < 1e-15);
    CHECK((m.system.body("slider").home.x - C).norm() < 1e-15);
    const auto world = [&](const char* name) {
      const Marker& marker = m.system.marker(name);
      return Vec3((marker.body->home * marker.local).x);
    };
    CHECK((world("eye") - C).norm() < 1e-15);
    CHECK((world("middle") - (0.5 * (B + C) + Vec3(rod / 10, 0, 0))).norm() < 1e-15);
    for (const char* name : {"JB.P", "JB.S"}) CHECK((world(name) - B).norm() < 1e-15);
    for (const char* name : {"guide.P", "guide.S"}) CHECK((world(name) - C).norm() < 1e-15);
    CHECK(m.run.until == 3 * 0.2);
  }
}

TEST_CASE("parameters are listed with their values", "[unit][scene]") {
  const Scene scene = scene_of(kScene);
  REQUIRE(scene.parameters.size() == 6);
  CHECK(scene.parameters[1].name == "rod");
  CHECK(*scene.parameters[1].value.text() == "0.3 m");
  CHECK(*scene.parameters[1].written.text() == "=2*crank");
  CHECK_FALSE(scene.parameters[1].is_point);
  CHECK(scene.parameters[4].is_point);
  CHECK(scene.written.find("bodies") != nullptr);
  CHECK(scene_of("\"bodies\": []").written.is_null());  // what is not in the scene costs nothing
}

TEST_CASE("parameters depend on one another in any order", "[unit][scene]") {
  const Scene scene = scene_of(R"("parameters": {"c": "=a + b", "b": "=2*a", "a": "1 mm", "n": 3, "v": "=P/n"},
                                  "points": {"P": ["=c", "=n*b", 0.5]})");
  CHECK(*scene.parameters[0].value.text() == "0.003 m");
  CHECK(*(*scene.parameters[4].value.list())[1].text() == "0.002 m");
  CHECK(*(*scene.parameters[5].value.list())[2].text() == "0.5 m");
}

TEST_CASE("a circle of parameters is named", "[unit][scene]") {
  check_words(refusal(R"("parameters": {"a": "=b + 1", "b": "=2*c", "c": "=a", "d": 1})"),
              {"s.json:1:37", "scene.parameters.a", "depends on itself: a -> b -> c -> a"});
  check_words(refusal(R"("parameters": {"a": "=P.x"}, "points": {"P": "=[a, 0, 0]"})"), {"a -> P -> a"});
  check_words(refusal(R"("parameters": {"a": "=a"})"), {"a -> a"});
  std::string chain = R"("parameters": {"p0": 1)";
  for (int k = 1; k < 150; ++k) chain += ", \"p" + std::to_string(k) + "\": \"=p" + std::to_string(k - 1) + " + 1\"";
  CHECK(*scene_of(chain + "}").parameters.back().value.number() == 150);
  std::string deep = R"("parameters": {"p300": 1)";
  for (int k = 0; k < 300; ++k) deep += ", \"p" + std::to_string(k) + "\": \"=p" + std::to_string(k + 1) + "\"";
  check_words(refusal(deep + "}"), {"more than 200 parameters depend on one another"});
}

TEST_CASE("a faulty formula is rejected with its key, formula and column", "[unit][scene]") {
  const std::string body = R"("parameters": {"crank": "0.1 m", "m": "2 kg", "n": 2}, "points": {"A": [0, 0, 0]},
    "bodies": [{"name": "b", "rod": {"mass": )";
  const auto with = [&](const std::string& mass, const std::string& to, const std::string& more = "") {
    return body + mass + ", \"from\": \"A\", \"to\": " + to + "}}]" + more;
  };
  check_words(refusal(with("\"=2*crnk\"", "[1, 0, 0]")),
              {"s.json:2:46: body 'b', rod.mass", "\"=2*crnk\", column 4", "did you mean \"crank\""});
  check_words(refusal(with("\"=crank + m\"", "[1, 0, 0]")), {"rod.mass", "column 8", "a length and a mass are added"});
  check_words(refusal(with("\"=2*crank\"", "[1, 0, 0]")),
              {"body 'b', rod.mass", "0.2 m", "is a length", "a mass is expected", "the formula \"=2*crank\""});
  check_words(refusal(with("\"=crank/(1 m)\"", "[1, 0, 0]")), {"0.1 1", "a mass is expected"});
  check_words(refusal(with("1", "\"B\"")), {"body 'b', rod.to", "unknown point \"B\"; known: A"});
  check_words(refusal(with("1", "\"=2*m\"")), {"rod.to", "formula \"=2*m\""});
  check_words(refusal(with("1", "\"=A\"")), {"both ends are at the same point"});
  check_words(refusal(with("1", "[1, 0, 0]", R"(, "run": {"until": "=crank"})")), {"run", "is a length", "a time"});
  check_words(refusal(with("1", "[1, 0, 0]", R"(, "gravity": [0, "=-n*9.81 m/s", 0])")), {"gravity", "a speed"});
  check_words(refusal(R"("parameters": {"sin": 1})"), {"\"sin\" cannot name a parameter", "function"});
  check_words(refusal(R"("parameters": {"2x": 1})"), {"\"2x\" cannot name", "does not begin with a digit"});
  check_words(refusal(R"("parameters": {"x": true})"), {"parameters.x", "expected a number"});
  check_words(refusal(R"("parameters": {"x": "5 mmm"})"), {"parameters.x", "unknown unit \"mmm\""});
  check_words(refusal(R"("parameters": [1])"), {"parameters", "expected an object"});
  check_words(refusal(R"("points": {"A": [0, 0]})"), {"points.A", "expected [x, y, z]"});
  check_words(refusal(R"("points": {"A": ["1 kg", "1 kg", "1 kg"]})"), {"points.A", "lengths", "mass"});
  check_words(refusal(R"("points": {"A": "=3 m"})"), {"points.A", "a point is [x, y, z]"});
  check_words(refusal(R"("parameters": {"A": 1}, "points": {"A": [0, 0, 0]})"), {"\"A\" is a parameter already"});
}

TEST_CASE("numbers of formulas are checked like written ones", "[unit][scene]") {
  const std::string scene = R"("parameters": {"n": 2, "L": "1 m"},
    "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0]}],
    "links": [{"name": "A", "type": "lock", "mask": "x", "p": "b", "s": "ground",
               "drive": {"axis": "y", "law": )";
  CHECK_NOTHROW(built(scene + R"~({"type": "ramp", "slope": "=L/(2 s)"
}
}
}])~"));
  CHECK_NOTHROW(built(scene + R"("=L/2"}}])"));
check_words(refusal(scene + R"({"type": "ramp", "slope": "=2*L"}}}])"), {"drive.law.slope", "a speed is expected"});
check_words(refusal(scene + R"({"type": "ramp", "slope": "=L/L"}}}])"), {"drive.law.slope", "a speed is expected"});
CHECK_NOTHROW(built(scene + R"({"type": "ramp", "slope": "=n/4"}}}])"));  // no unit took part: SI, as a written 0.5
CHECK_NOTHROW(built(scene + R"("1 m"}}], "run": {"max_steps": "=2*n"})"));
CHECK_NOTHROW(built(scene + R"("1 m"}}], "run": {"max_steps": "=4 m/L"})"));
check_words(refusal(scene + R"("1 m"}}], "run": {"max_steps": "=n/4"})"), {"max_steps", "a whole number"});
}

TEST_CASE("a marker in body axes takes formulas, and a point's place", "[unit][scene]") {
  const std::string scene = R"("points": {"P": [1, 2, 3]},
    "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0]}], "markers": [{"name": "m", "body": "b", )";
  const auto local = [&](const std::string& rest) { return Vec3(built(scene + rest).system.marker("m").local.x); };
  CHECK(local(R"("at": "P"}])") == Vec3(0, 2, 3));
  CHECK(local(R"("at": "=P"}])") == Vec3(1, 2, 3));
  check_words(refusal(scene + R"("at": "P", "orientation": [1, 0, 0, 0]}])"), {"world", "remove \"orientation\""});
  check_words(refusal(scene + R"("at": "Q"}])"), {"unknown point \"Q\""});
}

TEST_CASE("parameters are set and varied by name", "[unit][scene]") {
  const Scene scene = scene_of(kScene);
  const auto refused = [&](const std::string& text) {
    return message_of<ModelError>([&] { set_in_scene(scene, {text}, builtin()); });
  };
  CHECK(*set_in_scene(scene, {"crank=0.3"}, builtin()).parameters[1].value.text() == "0.6 m");
  CHECK(*set_in_scene(scene, {"crank = 300 mm"}, builtin()).parameters[0].value.text() == "0.3 m");
  CHECK(*set_in_scene(scene, {"rod==2*crank"}, builtin()).parameters[1].value.text() == "0.3 m");
  CHECK(*set_in_scene(scene, {"parameters.phi=0.1"}, builtin()).parameters[2].value.text() == "0.1 rad");
  CHECK(set_in_scene(scene, {"run.until=2"}, builtin()).run.until == 2);
  CHECK(set_in_scene(scene, {"crank=0.3", "rod=0.2"}, builtin()).parameters.size() == 6);
  // each alone breaks the formula, both together do not
  const Scene narrow = scene_of(R"~("parameters": {"a": 3, "b": 5, "c": "=asin(a/b)"})~");
  CHECK(*set_in_scene(narrow, {"a=30", "b=50"}, builtin()).parameters[2].value.text() ==
        *narrow.parameters[2].value.text());
  check_words(message_of<SceneError>([&] { set_in_scene(narrow, {"a=30"}, builtin()); }), {"asin of 6"});
  check_words(refused("crank=3 kg"), {"\"crank\"", "3 kg", "m is expected"});
  check_words(refused("crnak=3"), {"\"crnak\"", "did you mean \"crank\""});
  check_words(refused("crank"), {"NAME=VALUE"});
  check_words(refused("=3"), {"NAME=VALUE"});

  const Variable v = read_variable("crank=100 mm:200 mm:3", scene, builtin());
  CHECK(v.unit == "m");
  CHECK(v.place == "parameters.crank");
  REQUIRE(v.values.size() == 3);
  const Scene third = vary_scene(scene, {v}, {2}, builtin());
  CHECK(*third.parameters[1].value.text() == "0.4 m");
  CHECK(setting_text({v}, {1}) == "crank = 0.15 m");
  check_words(message_of<ModelError>([&] { read_variable("crank=1 s,2 s", scene, builtin()); }), {"m is expected"});
  check_words(message_of<ModelError>([&] { read_variable("crank=1 m,2 s", scene, builtin()); }), {"m is expected"});
}

TEST_CASE("a length that is written again elsewhere is named when it varies", "[unit][scene]") {
  const Scene scene = scene_of(R"("bodies": [
      {"name": "crank", "rod": {"mass": 0.15, "from": [0, 0, 0], "to": ["150 mm", 0, 0]}},
      {"name": "rod", "rod": {"mass": 2, "from": [0.15, 0, 0], "to": [0.5, 0, 0]}}],
    "links": [{"name": "B", "type": "revolute", "p": "rod", "s": "crank", "at": [0.15, 0, 0]}])");
  const auto left = [&](const char* text) {
    return left_behind(read_variable(text, scene, builtin()), scene, builtin());
  };
  CHECK(left("bodies.crank.rod.to.0=0.1,0.2") == std::vector<std::string>{"bodies.rod.rod.from.0", "joints.B.at.0"});
  CHECK(left("bodies.crank.rod.mass=1,2").empty());    // no length
  CHECK(left("bodies.rod.rod.to.0=1,2").empty());      // stands once
  CHECK(left("bodies.crank.rod.from.0=1,2").empty());  // zero says nothing
  CHECK(left_behind(read_variable("crank=1,2", scene_of(kScene), builtin()), scene_of(kScene), builtin()).empty());
}

TEST_CASE("an unknown name that varies is answered by the parameters, a joint by its path", "[unit][scene]") {
  const Scene scene = scene_of(kScene);
  const auto said = [&](const char* text) {
    return message_of<ModelError>([&] { read_variable(text, scene, builtin()); });
  };
  check_words(said("Q=1,2"), {"\"Q\" is not a parameter of the scene; known: ", "crank"});
  check_words(said("tolerance=1,2"), {"\"tolerance\" is not a parameter of the scene; did you mean \"run.tolerance\"?"});
  check_words(said("joints.Q.at.0=1,2"), {"\"joints\" has no \"Q\""});
}

TEST_CASE("laws by formula read the scene's parameters in SI", "[unit][scene]") {
  const std::string scene = R"("parameters": {"a": "100 mm", "w": 3, "T": "500 ms"}, "points": {"P": [0, 4, 0]},
    "bodies": [{"name": "b", "particle": 1, "position": [1, 0, 0]}],
    "links": [{"name": "A", "type": "lock", "mask": "x", "p": "b", "s": "ground",
               "drive": {"axis": "y", "law": {"type": "formula", "y": )";
  const auto law_of = [&](const std::string& law) {
    const Mechanism m = built(scene + law + "}}}]");
    std::vector<double> breaks = passes::breakpoints(m.system, 0, 10);
    return breaks;
  };
  CHECK(law_of(R"~("=a*sin(w*t) + (t > 2*T ? P.y*(t - 1)^2 : 0)")~") == std::vector<double>{1});
  CHECK(law_of(R"("=b*t > 6 ? 1 : 0", "parameters": {"b": "=2*w"})") == std::vector<double>{1});
  CHECK(law_of(R"("=a*t > 6 ? 1 : 0", "parameters": {"a": 3})") == std::vector<double>{2});  // its own come first
  check_words(refusal(scene + R"~("=a*sinn(w*t)"
}
}
}])~"),
              {"joint 'A', drive.law.y", "column 4", "did you mean \"sin\""});
  check_words(refusal(scene + R"("=a*x"}}}])"), {"unknown name \"x\""});
  check_words(refusal(scene + R"("=a*P"}}}])"), {"P.x"});
}

TEST_CASE("repeated parts have an index in names, points and formulas", "[unit][scene]") {
  const std::string chain = R"~("parameters": {"n": 3, "L": "200 mm"},
    "repeat": [{"times": "=n + 1", "index": "k", "points": {"P{k}": "=[k*L, 3 m, 0]"}},
               {"times": "=n", "from": 1, "index": "k",
                "bodies": [{"name": "rod_{k}", "rod": {"mass": "=k*1 kg", "from": "P{k-1}", "to": "P{k}"}}],
                "markers": [{"name": "m{2*k}", "body": "rod_{k}", "at": "P{k}"}]},
               {"times": 2, "from": 2, "index": "k",
                "links": [{"name": "J{k}", "type": "revolute", "p": "rod_{k}", "s": "rod_{k-1}", "at": "P{k-1}",
                           "drive": {"axis": "rz", "law": {"type": "formula", "y": "=k*t > 1 ? 1 : 0"}}}]}],
    "links": [{"name": "J1", "type": "revolute", "p": "rod_1", "s": "ground", "at": "P0"}])~";
  const Scene scene = scene_of(chain);
  CHECK(scene.root.find("repeat") == nullptr);
  CHECK(scene.written.find("repeat") != nullptr);
  const Mechanism m = build_mechanism(scene, builtin());
  REQUIRE(m.system.links().size() == 3);
  for (int k = 1; k <= 3; ++k) {
    const Body& rod = m.system.body("rod_" + std::to_string(k));
    CHECK((rod.home.x - Vec3(0.2 * k - 0.1, 3, 0)).norm() < 1e-15);
    CHECK(rod.mass.mass == k);
    const Marker& end = m.system.marker("m" + std::to_string(2 * k));
    CHECK(((end.body->home * end.local).x - Vec3(0.2 * k, 3, 0)).norm() < 1e-15);
  }
  CHECK(passes::breakpoints(m.system, 0, 1) == std::vector<double>{1.0 / 3, 0.5});
  CHECK(set_in_scene(scene, {"n=5"}, builtin()).parameters.size() == 2 + 6);

  check_words(refusal(R"("repeat": {"times": 2})"), {"scene.repeat", "expected a list"});
  check_words(refusal(R"("repeat": [{"index": "i"}])"), {"repeat[0]", "missing key \"times\""});
  check_words(refusal(R"("repeat": [{"times": -1}])"), {"repeat[0].times", "it is -1"});
  check_words(refusal(R"("repeat": [{"times": 1000000000}])"), {"from 0 to 100000"});
  check_words(refusal(R"("repeat": [{"times": 1, "body": []}])"), {"repeat[0]", "unknown key \"body\"", "bodies"});
  check_words(refusal(R"("parameters": {"i": 1}, "repeat": [{"times": 1}])"), {"\"i\" is a parameter"});
  check_words(refusal(R"("repeat": [{"times": 1, "bodies": [{"name": "b{i/2+0.1}", "particle": 1}]}])"),
              {"repeat[0].bodies", "b{i/2+0.1}", "an integer is expected"});
  check_words(refusal(R"("repeat": [{"times": 1, "bodies": [{"name": "b{i", "particle": 1}]}])"), {"without \"}\""});
  check_words(refusal(R"("repeat": [{"times": 1, "bodies": {"name": "b"}}])"),
              {"repeat[0].bodies", "a list of objects"});
  check_words(refusal(R"("repeat": [{"times": 2, "bodies": [{"name": "b", "particle": 1}]}])"), {"already taken"});
  check_words(refusal(R"("repeat": [{"times": 2, "points": {"P": [0, 0, 0]}}])"), {"\"P\" is a point already"});
}

TEST_CASE("an index below zero is in brackets in formulas", "[unit][scene]") {
  const Mechanism m = built(R"~("repeat": [{"times": 2, "from": -1, "index": "i",
    "bodies": [{"name": "b{i+1}", "particle": 1, "position": ["=i^2", "=3-i", "={i}^2"]}]}])~");
  CHECK((m.system.body("b0").home.x - Vec3(1, 4, 1)).norm() == 0);
  CHECK((m.system.body("b1").home.x - Vec3(0, 3, 0)).norm() == 0);
  CHECK(built(R"~("repeat": [{"times": 1, "from": -1, "bodies": [{"name": "b{i}", "particle": 1}]}])~")
            .system.body("b-1")
            .name == "b-1");
}

TEST_CASE("an index is no unit", "[unit][scene]") {
  for (const char* unit : {"s", "m", "kg", "N", "rad"})
    check_words(refusal(R"("repeat": [{"times": 1, "index": ")" + std::string(unit) + R"("}])"),
                {"repeat[0].index", "\"" + std::string(unit) + "\" is a unit", "choose another name"});
}

TEST_CASE("a parameter with the name of a variable is rejected in a formula that reads it", "[unit][scene]") {
  const std::string particle = R"("bodies": [{"name": "b", "particle": 1}], )";
  const auto law = [&](const std::string& parameters, const std::string& y) {
    return "\"parameters\": {" + parameters + "}, " + particle +
           R"("links": [{"name": "A", "type": "lock", "mask": "x", "p": "b", "s": "ground",
                         "drive": {"axis": "y", "law": {"type": "formula", "y": )" +
           y + "}}}]";
  };
  check_words(refusal(law(R"("t": 3)", R"("=2*t")")),
              {"joint 'A', drive.law.y", "\"=2*t\"", "\"t\" is both a variable", "rename the parameter"});
  check_words(refusal(law(R"("w": 3)", R"("=2*t", "parameters": {"t": 1})")), {"\"t\" is both a variable"});
  CHECK_NOTHROW(built(law(R"("q": 3)", R"("=q*t")")));  // a law knows no q
  const auto force = [&](const std::string& parameters) {
    return "\"parameters\": {" + parameters + "}, " + particle +
           R"("forces": [{"name": "F", "type": "function_force", "p": "b", "s": "ground", "at": [0, 0, 0],
                          "force": "=-3*q"}])";
  };
  check_words(refusal(force(R"("q": 3)")), {"force 'F', force", "\"q\" is both a variable"});
  CHECK_NOTHROW(built(force(R"("qd": 3)")));  // not read
  check_words(refusal("\"parameters\": {\"z\": 2}, " + particle +
                      R"("links": [{"name": "A", "type": "function", "p": "b", "s": "ground", "at_s": [0, 0, 0],
                                    "phi": ["=x", "=z - y"]}])"),
              {"joint 'A', phi[1]", "\"z\" is both a variable"});
}

TEST_CASE("a scene is a part of another, with a prefix and parameters", "[unit][scene]") {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("lockstep_include_test_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const std::string& members) {
    std::ofstream(folder / name) << "{\"lockstep\": 1, " << members << "}";
  };
  write("leg.json", R"~("parameters": {"L": "1 m", "at": [0, 0, 0], "w": 2},
    "points": {"hip": "=[at.x, at.y, 0]*1 m", "foot": "=hip + [0, -L, 0]"},
    "bodies": [{"name": "leg", "rod": {"mass": 1, "from": "hip", "to": "foot"}}],
    "markers": [{"name": "end", "body": "leg", "at": "foot"}],
    "links": [{"name": "H", "type": "revolute", "p": "leg", "s": "ground", "at": "hip",
               "drive": {"axis": "rz", "law": {"type": "formula", "y": "=t > w ? 1 : 0"}}}],
    "events": [{"name": "low", "when": {"channel": "leg.x@end", "crosses": 0}, "deactivate": ["H"]}],
    "run": {"until": 7})~");
  const auto read = [&](const std::string& members) {
    return scene_from_text("{\"lockstep\": 1, " + members + "}", (folder / "robot.json").string());
  };
  const std::string robot = R"~("parameters": {"gap": "2 m", "n": 3}, "run": {"until": 1},
    "include": [{"scene": "leg.json", "prefix": "left_"},
                {"scene": "leg.json", "prefix": "right_", "parameters": {"L": "=gap/4", "at": [5, 0, 0], "w": "=n"}}],
    "bodies": [{"name": "hips", "box": {"mass": 1, "size": [1, 1, 1]}, "position": "=right_hip + [gap, 0, 0]"}],
    "links": [{"name": "mesh", "type": "gear", "pairs": ["left_H", "right_H"], "teeth_1": 20, "teeth_2": 20}])~";
  const Mechanism m = build_mechanism(read(robot), builtin());
  CHECK((m.system.body("left_leg").home.x - Vec3(0, -0.5, 0)).norm() < 1e-15);
  CHECK((m.system.body("right_leg").home.x - Vec3(5, -0.25, 0)).norm() < 1e-15);
  CHECK((m.system.body("hips").home.x - Vec3(7, 0, 0)).norm() < 1e-15);
  CHECK(m.system.marker("right_end").body == &m.system.body("right_leg"));
  CHECK(passes::breakpoints(m.system, 0, 10) == std::vector<double>{2, 3});
  CHECK(m.run.until == 1);
  REQUIRE(m.events.size() == 2);
  CHECK(m.events[1].channel == "right_leg.x@right_end");
  CHECK(m.events[1].event.deactivate == std::vector<std::string>{"right_H"});
  const Scene longer = set_in_scene(read(robot), {"include.1.parameters.L=3 m"}, builtin());
  CHECK(build_mechanism(longer, builtin()).system.body("right_leg").home.x[1] == -1.5);

  const auto refused = [&](const std::string& members) {
    return message_of<Error>([&] { build_mechanism(read(members), builtin()); });
  };
  write("self.json", R"("include": [{"scene": "self.json"}])");
  check_words(refused(R"("include": [{"scene": "self.json"}])"), {"self.json:1:", "includes itself"});
  check_words(refused(R"("include": [{"scene": "gone.json"}])"), {"gone.json", "No such file"});
  write("half.json", R"("bodies": [{"name": "r", "rod": {"mass": 1, "from": [0, 0, 0]}}])");  // it is moved, and refused
  check_words(refused(R"("include": [{"scene": "half.json", "at": [1, 0, 0]}])"), {"half.json:1:", "\"to\""});
  check_words(refused(R"("include": [{"scene": "leg.json"}, {"scene": "leg.json"}])"), {"already"});
  check_words(refused(R"("include": [{"scene": "leg.json", "parameters": {"l": 2}}])"),
              {"robot.json", "include[0].parameters", "no parameter \"l\"", "did you mean \"L\""});
  check_words(refused(R"("include": [{"scene": "leg.json", "parameters": {"L": "=q"}}])"), {"unknown name \"q\""});
  check_words(refused(R"("include": [{"scene": "leg.json", "parameters": {"L": "2 kg"}}])"), {"leg.json", "are added"});
  check_words(refused(R"("include": {"scene": "leg.json"})"), {"expected a list of objects"});
}

}  // namespace parameters_test
