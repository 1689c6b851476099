// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/scene.h>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace vary_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

const char* const kText = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
  "bodies": [{"name": "bob", "particle": 2, "position": ["300 mm", 0, 0]}],
  "links": [{"name": "A", "type": "lock", "mask": "x", "p": "bob", "s": "ground",
             "drive": {"axis": "y", "law": {"type": "sine", "amplitude": 0.1, "frequency": 1}}}],
  "run": {"until": 1, "solver": {"type": "sparse"}, "record": ["bob.x"]}})";

struct Read {
  Registry registry = builtin_registry();
  Scene scene = scene_from_text(kText, "scene.json");
  Variable operator()(const std::string& text) const { return read_variable(text, scene, registry); }
  std::string refusal(const std::string& text) const {
    return message_of<Error>([&] { (*this)(text); });
  }
};

std::vector<double> numbers(const Variable& v) {
  std::vector<double> x;
  for (const Value& value : v.values) x.push_back(*value.number());
  return x;
}

}  // namespace

TEST_CASE("a range meets both ends and lies evenly between", "[unit][scene]") {
  const Read read;
  CHECK(numbers(read("bodies.bob.particle=1:5:5")) == std::vector<double>{1, 2, 3, 4, 5});
  CHECK(numbers(read("gravity.1 = 0.1 : 0.5 : 5")) == std::vector<double>{0.1, 0.2, 0.3, 0.4, 0.5});
  CHECK(numbers(read("gravity.1=-1e308:1e308:3")) == std::vector<double>{-1e308, 0, 1e308});
  CHECK(numbers(read("bodies.bob.position.0=50 mm:90 mm:9"))[1] == 0.055);  // no digits of rounding
  CHECK(numbers(read("gravity.1=5:1:2")) == std::vector<double>{5, 1});
  CHECK(numbers(read("bodies.bob.particle=1:1e3:4:log")) == std::vector<double>{1, 10, 100, 1000});
  CHECK(numbers(read("bodies.bob.position.0=1mm:0.1m:3:log")) == std::vector<double>{0.001, 0.01, 0.1});
  const Variable length = read("bodies.bob.position.0=200 mm:1 m:3");
  CHECK(numbers(length) == std::vector<double>{0.2, 0.6, 1});
  CHECK(length.unit == "m");
  CHECK(numbers(read("bodies.bob.position.0=0:20mm:2")) == std::vector<double>{0, 0.02});
}

TEST_CASE("a list takes numbers, units, words, true and false", "[unit][scene]") {
  const Read read;
  const Variable mass = read("bodies.bob.particle=1,500 g,0.25kg");
  CHECK(numbers(mass) == std::vector<double>{1, 0.5, 0.25});
  CHECK(mass.unit == "kg");
  CHECK(mass.place == "bodies.bob.particle");
  CHECK(read("bodies.0.particle=1").place == "bodies.bob.particle");
  CHECK(*read("run.integrator=rk4,dopri5").values[1].text() == "dopri5");
  CHECK(*read("run.assemble=true,false").values[1].boolean() == false);
  CHECK(*read("planar=off,z").values[1].text() == "z");
  CHECK(read("links.A.drive.law.amplitude=10 mm,0.2 m").unit == "m");  // of any dimension, but of one
}

TEST_CASE("values that are impossible at their place are rejected", "[unit][scene]") {
  const Read read;
  check_words(read.refusal("bodies.bob.particle=1 mm"), {"bodies.bob.particle", "is a length; here a mass is expected"});
  check_words(read.refusal("bodies.bob.particle=heavy"), {"bodies.bob.particle", "heavy"});
  check_words(read.refusal("bodies.bob.particle=nan"), {"finite"});
  check_words(read.refusal("bodies.bob.particle=1,,2"), {"a value is missing"});
  check_words(read.refusal("bodies.bob.particle="), {"a value is missing"});
  check_words(read.refusal("bodies.bob.particle"), {"expected NAME=a:b:n"});
  check_words(read.refusal("=1"), {"expected NAME=a:b:n"});
  check_words(read.refusal("bodies.bob.particle=1:5"), {"expected a:b:n"});
  check_words(read.refusal("bodies.bob.particle=1:5:2:3"), {"expected a:b:n"});
  check_words(read.refusal("bodies.bob.particle=0:5:2:log"), {"a and b above 0"});
  for (const char* n : {"1", "0", "-3", "2.5", "x", "1000001"})
    check_words(read.refusal(std::string("bodies.bob.particle=1:5:") + n), {"an integer from 2 to 1000000"});
  check_words(read.refusal("bodies.bob.particle=1:500 g:3"), {"has a unit, the other has none"});
  check_words(read.refusal("links.A.drive.law.amplitude=10 mm,30 deg"), {"a length and an angle", "mixed"});
  check_words(read.refusal("run.integrator=dopri"), {"did you mean \"dopri5\"?"});
  check_words(read.refusal("run.integrator=a:b:3"), {"is not a number"});
  check_words(read.refusal("run.assemble=maybe"), {"expected true or false"});
  check_words(read.refusal("planar=w"), {"\"auto\""});
  check_words(read.refusal("run.record.0=bob.y"), {"cannot vary"});
  check_words(read.refusal("gravity=1,2"), {"\"gravity\" has several values", "vary one of them, such as gravity.x"});
  check_words(read.refusal("joints.A.axis=1,2"),
              {"\"joints.A.axis\" has several values", "write it in the scene as [x, y, z], and vary"});
  check_words(read.refusal("bodies.bob.omega_body=1,2"), {"has several values", "such as bodies.bob.omega_body.x"});
  check_words(read.refusal("bodies.bob.particel=1"), {"did you mean \"bodies.bob.particle\"?"});
}

TEST_CASE("the same place does not vary twice, by any path", "[unit][scene]") {
  const Read read;
  const auto twice = [&](const char* a, const char* b) {
    return message_of<ModelError>([&] { read_variables({a, b}, read.scene, read.registry); });
  };
  check_words(twice("gravity.1=1", "gravity.1=2"), {"\"gravity.1\" varies twice"});
  check_words(twice("bodies.bob.particle=1", "bodies.0.particle=2"), {"varies twice", "as \"bodies.bob.particle\""});
}

TEST_CASE("the varied scene has the values, the first one is as before", "[unit][scene]") {
  const Read read;
  const std::vector<Variable> all = read_variables(
      {"bodies.bob.particle=3,4", "run.tolerance=1e-4,1e-9", "bodies.bob.velocity.1=5", "run.solver.type=dense"},
      read.scene, read.registry);
  const Scene scene = vary_scene(read.scene, all, {1, 1, 0, 0}, read.registry);
  CHECK(scene.run.tolerance.relative == 1e-9);
  CHECK(scene.run.solver.type == "dense");
  CHECK(scene.file == "scene.json");
  const Mechanism m = build_mechanism(scene, read.registry);
  CHECK(m.system.body("bob").mass.mass == 4);
  CHECK(m.system.body("bob").start.v == Vec3(0, 5, 0));
  CHECK(setting_text(all, {1, 1, 0, 0}) ==
        "bodies.bob.particle = 4 kg, run.tolerance = 1e-09, bodies.bob.velocity.1 = 5 m/s, run.solver.type = dense");
  CHECK(build_mechanism(read.scene, read.registry).system.body("bob").mass.mass == 2);
  CHECK(read.scene.root.find("run")->find("tolerance") == nullptr);
}

TEST_CASE("an impossible value is rejected with the place of the replaced one", "[unit][scene]") {
  const Read read;
  const std::vector<Variable> all = read_variables({"bodies.bob.particle=-1"}, read.scene, read.registry);
  const Scene scene = vary_scene(read.scene, all, {0}, read.registry);
  check_words(message_of<SceneError>([&] { build_mechanism(scene, read.registry); }),
              {"scene.json:2:", "body 'bob'", "-1"});
}

}  // namespace vary_test
