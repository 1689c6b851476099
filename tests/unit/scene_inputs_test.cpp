// SPDX-License-Identifier: BSD-3-Clause
// Inputs of scenes: the law "input", set by a host between steps.
#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/system.h>
#include "tests/support/catch.h"
#include "tests/support/law_checks.h"

namespace scene_inputs_test {

using namespace lockstep;
using lockstep::test::says;

// A slider of 2 kg with a motor, and another force with a law.
Mechanism slider(const std::string& law, const std::string& other = "0") {
  return read_mechanism(scene_from_text(R"({"lockstep": 1,
    "bodies": [{"name": "m", "sphere": {"mass": 2, "radius": 0.1}}],
    "joints": [{"name": "A", "type": "prismatic", "p": "m", "s": "ground", "at": [0, 0, 0], "axis": "z"}],
    "forces": [{"name": "motor", "type": "force_motor", "p": "m", "s": "ground", "at": [0, 0, 0], "force": )" +
                                            law + R"(},
               {"name": "second", "type": "force_motor", "p": "m", "s": "ground", "at": [0, 0, 0], "force": )" +
                                            other + R"(}],
    "run": {"tolerance": 1e-10, "output": 0.01, "record": ["m.z", "u.value"]}})",
                                        "slider.json"),
                        builtin_registry());
}

TEST_CASE("a force of a scene acts by an input", "[unit][scene]") {
  Simulation run(slider(R"({"type": "input", "name": "u", "value": "0.5 N"})"));
  REQUIRE(run.system().control_inputs().size() == 1);
  CHECK(run.input("u").value() == 0.5);
  double z = 0, v = 0;
  for (int k = 0; k < 50; ++k) {
    const double u = std::sin(0.2 * k);
    run.input("u").set(u);
    run.advance(0.01);
    z += 0.01 * v + 0.5 * (u / 2) * 1e-4, v += u / 2 * 0.01;
  }
  CHECK(run.state().slot_pose(0).x.z() == Approx(z).epsilon(1e-11));
}

TEST_CASE("laws of one name share an input", "[unit][scene]") {
  const std::string u = R"({"type": "input", "name": "u"})";
  Simulation run(slider(u, R"({"type": "sum", "laws": [)" + u + "," + u + "]}"));
  REQUIRE(run.system().control_inputs().size() == 1);
  run.input("u").set(2);
  run.run_until(1);
  CHECK(run.state().slot_pose(0).x.z() == Approx(0.5 * 3 * 2 / 2.0).epsilon(1e-9));
}

TEST_CASE("inputs that contradict one another are errors", "[unit][scene]") {
  const std::string u = R"({"type": "input", "name": "u", "value": 1})";
  CHECK_THROWS_WITH(slider(u, R"({"type": "input", "name": "u", "value": 2})"),
                    says("input 'u'") && says("give one value"));
  CHECK_THROWS_AS(slider(R"({"type": "input", "name": "m"})"), SceneError);  // a body
  CHECK(builtin_registry().scalar_law(Value::object({{"type", "input"}, {"name", "u"}, {"value", 3.0}}))->at(7).y == 3);
}

}  // namespace scene_inputs_test
