// SPDX-License-Identifier: BSD-3-Clause
// The example plugins pass the checks that everybody's plugins can be held against, and do what they say.
#include <cmath>

#include <lockstep/author/check.h>
#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace examples_test {

using namespace lockstep;
using lockstep::testing::call, lockstep::testing::Called, lockstep::testing::contains, lockstep::testing::scene_file;

namespace {

Registry registry_with(const char* plugin) {
  Registry registry = builtin_registry();
  load_plugin(registry, plugin, {paths::kPlugins});
  return registry;
}

std::string refusal(const std::function<void()>& make) {
  try {
    make();
  } catch (const SceneError& e) {
    return e.what();
  }
  return "not refused";
}

}  // namespace

TEST_CASE("the plugin cam_follower passes check_lock", "[plugin][check]") {
  const CheckReport r =
      check_lock(registry_with("cam_follower"), "cam_follower", {{"base", 0.05}, {"lift", 0.03}, {"lobes", 3}});
  INFO(r.text());
  CHECK(r.ok());
}

TEST_CASE("the plugin bump passes check_law", "[plugin][check]") {
  const Registry registry = registry_with("bump");
  const auto law = registry.laws.make("bump", {{"height", 0.2}, {"at", 1.1}, {"width", 0.4}}, &registry, "law");
  const CheckReport r = check_law(*law);
  INFO(r.text());
  CHECK(r.ok());
  CHECK(r.notes().empty());  // its two ends are breakpoints
  CHECK(law->at(1.1).y == Approx(0.2));
}

TEST_CASE("an adaptive run does not step over a pulse of a force", "[plugin]") {
  const std::string up = R"({"type": "cycloid", "rise": 100, "duration": 0.1)",
                    down = R"({"type": "cycloid", "rise": -100, "duration": 0.1)";
  const auto [law, impulse] = GENERATE_COPY(table<std::string, double>(
      {{R"({"type": "bump", "height": 100, "at": 5, "width": 0.1})", 100 * 0.1 * 32 / 35},
       {R"({"type": "sum", "laws": [)" + up + R"(, "t0": 4.9}, )" + down + R"(, "t0": 5}]})", 10},
       {R"({"type": "sequence", "continue": true, "durations": [4.9, 0.1, 0.1, 5], "laws": [0, )" + up + "}, " + down +
            "}, 0]}",
        10}}));
  const std::string scene = scene_file("pulse", R"("requires": ["bump"], "bodies": [{"name": "cart", "particle": 2}],
    "forces": [{"name": "push", "type": "force_motor", "p": "cart", "s": "ground", "axis": "x", "at": [0, 0, 0],
                "force": )" + law + R"(}],
    "run": {"until": 10, "output": 10, "record": ["cart.vx"]})");
  const Called run = call("run '" + scene + "' --record - --quiet");
  INFO(run.text);
  CHECK(run.exit == 0);
  const std::size_t last = run.text.find("\n10,");
  REQUIRE(last != std::string::npos);
  CHECK(std::stod(run.text.substr(last + 4)) == Approx(impulse / 2).epsilon(1e-5));
}

TEST_CASE("the plugin drag passes check_force and slows a ball to its terminal speed", "[plugin][check]") {
  const Registry registry = registry_with("drag");
  for (const Params& params : {Params{{"coefficient", 0.7}}, Params{{"area", 0.2}, {"shape", 0.47}}}) {
    const CheckReport r = check_force(registry, "drag", params);
    INFO(r.text());
    CHECK(r.ok());
  }
  // v = vt tanh(g t/vt), vt = sqrt(m g/c), falling from rest
  System system({.gravity = {0, 0, -9.81}});
  Body& ball = system.add_particle("ball", 2.0, {0, 0, 0});
  Marker& p = system.add_marker("p", ball);
  system.add(registry.forces.make("drag", {"drag", {{&p, nullptr}}}, {{"coefficient", 0.3}}, &registry, "force"));
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, registry.integrators.make("dopri5", {}, &registry, "integrator"),
                 {.tolerance = {1e-10, 1e-12}});
  run.run_until(1.5);
  const double vt = std::sqrt(2.0 * 9.81 / 0.3);
  CHECK(run.state().v[2] == Approx(-vt * std::tanh(9.81 * 1.5 / vt)).epsilon(1e-8));

  const auto make = [&](Params params) {
    return refusal([&] { registry.forces.make("drag", {"drag", {{&p, nullptr}}}, params, &registry, "force 'drag'"); });
  };
  CHECK(contains(make({}), "give one of the two"));
  CHECK(contains(make({{"coefficient", -1}}), "must not be negative"));
}

TEST_CASE("the example of a plugin's force builds, with one of the keys that it wants", "[plugin]") {
  const Called described = call("describe drag --plugin drag");
  INFO(described.text);
  const std::size_t from = described.text.find("{\"name\": \"F\", \"type\": \"drag\"");
  REQUIRE(from != std::string::npos);
  const std::string example = described.text.substr(from, described.text.find('\n', from) - from);
  CHECK(contains(example, "\"coefficient\": 1}"));
  const std::string scene = scene_file(
      "drag_example",
      R"("requires": ["drag"], "bodies": [{"name": "arm", "rod": {"mass": 1, "from": [0,0,0], "to": [1,0,0]}}],
    "forces": [)" +
          example + R"(], "run": {"until": 1})");
  const Called checked = call("check '" + scene + "'");
  INFO(checked.text);
  CHECK(checked.exit == 0);
}

TEST_CASE("the plugin adams_bashforth passes check_integrator in every order", "[plugin][check]") {
  const Registry registry = registry_with("adams_bashforth");
  for (int order = 2; order <= 4; ++order) {
    const CheckReport r = check_integrator(registry, "adams_bashforth", {{"order", order}});
    INFO(r.text());
    CHECK(r.ok());
  }
  CHECK(contains(refusal([&] {
                   registry.integrators.make("adams_bashforth", {{"order", 5}}, &registry, "integrator");
                 }),
                 "must be 2, 3 or 4"));
}

TEST_CASE("adams_bashforth evaluates once per step and restarts if its history does not fit", "[plugin][check]") {
  const Registry registry = registry_with("adams_bashforth");
  System system({.gravity = {0, 0, -9.81}});
  system.add_body("top", MassProperties{2.0, Vec3::Zero(), Vec3(0.4, 0.4, 0.7).asDiagonal()}).start.w = {1, 0.5, 2};
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  const auto method = registry.integrators.make("adams_bashforth", {}, &registry, "integrator");
  State state = system.start();
  method->begin(dynamics, state);
  const auto evaluations = [&](double h) {
    const long before = dynamics.work().evaluations;
    method->step(dynamics, state, h);
    return dynamics.work().evaluations - before;
  };
  for (int i = 0; i < 3; ++i) CHECK(evaluations(0.01) == 4);  // the start
  for (int i = 0; i < 5; ++i) CHECK(evaluations(0.01) == 1);
  CHECK(evaluations(0.006) == 1);  // a little shorter
  CHECK(evaluations(0.01) == 1);
  CHECK(evaluations(0.05) == 4);  // much longer
  state.v[3] += 0.1;              // pushed
  for (int i = 0; i < 3; ++i) CHECK(evaluations(0.01) == 4);
  CHECK(evaluations(0.01) == 1);
}

TEST_CASE("adams_bashforth keeps its history together with a counted angle", "[plugin][check]") {
  const Registry registry = registry_with("adams_bashforth");
  System system({.gravity = {0, -9.81, 0}});
  Body& arm = system.add_body("arm", MassProperties{2.0, Vec3(0.5, 0, 0), Mat3::Identity()});
  Lock& hinge = system.add<Revolute>("A", arm, system.ground(), pose_at({0, 0, 0}));
  system.count(*hinge.pairs().front().first, *hinge.pairs().front().second, 2);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, registry.integrators.make("adams_bashforth", {}, &registry, "integrator"), {.step = 1e-3});
  loop.run_until(0.5);
  CHECK(dynamics.work().evaluations < 600);  // one a step, four at the start
}

}  // namespace examples_test
