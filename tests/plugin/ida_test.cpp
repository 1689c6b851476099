// SPDX-License-Identifier: BSD-3-Clause
// The plugin ida: BDF of SUNDIALS on mechanisms, stiff and not.
#include <string>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "tests/support/catch.h"
#include "tests/support/course.h"
#include "tests/support/messages.h"
#include "tests/support/paths.h"
#include "tests/support/program.h"

namespace ida_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

Registry with_ida() {
  Registry registry = builtin_registry();
  load_plugin(registry, "ida", {paths::kPlugins});
  return registry;
}

}  // namespace

TEST_CASE("the plugin ida adds its integrator and rejects orders that it does not have", "[plugin][ida]") {
  const Registry registry = with_ida();
  REQUIRE(registry.integrators.find("ida") != nullptr);
  CHECK(registry.integrators.find("ida")->origin == "ida");
  const auto with_order = [&](int order) {
    return registry.integrators.make("ida", Params{{"max_order", order}}, nullptr, "integrator");
  };
  CHECK(with_order(3)->info().order == 3);
  CHECK(with_order(3)->info().implicit);
  CHECK_THROWS_WITH(with_order(6), Catch::Matchers::Contains("max_order") && Catch::Matchers::Contains("is 6"));
  testing::check_words(testing::message_of<SceneError>([&] { with_order(0); }), {"max_order", "is 0", "orders 1 to 5"});
}

TEST_CASE("the flyball governor holds to 1e-4 m with ida", "[plugin][ida]") {
  const SceneRun run =
      run_with_registry(with_ida(), std::string(paths::kScenes) + "/flyball.json", [&](RunSettings& s) {
        s.integrator = {"ida"};
        s.tolerance = {1e-6, 1e-8};
      });
  const Table truth = read_csv(std::string(paths::kSource) + "/tests/verification/data/flyball.csv");
  int n_compared = 0;
  for (const ColumnError& e : compare(run.table, truth)) {
    CAPTURE(e.name, e.error, e.size);
    if (e.name != "s" && e.name != "alpha" && e.name != "spring_length") continue;
    CHECK(e.error < 1e-4);
    ++n_compared;
  }
  CHECK(n_compared == 3);
  CHECK(run.report.steps < 8000);  // stability would ask an explicit method of order 5 for more than 80 000
  CHECK(run.report.largest_violation < 1e-9);
}

// Times of the csv lie inside steps: this is the error of dense output too.
TEST_CASE("the error of ida follows the tolerance with slope one", "[plugin][ida]") {
  const Registry registry = with_ida();
  const Course course = GENERATE(kTopCourse, kDoublePendulumCourse);
  std::vector<double> tolerances, errors;
  for (int k = 3; k <= 10; ++k) {
    tolerances.push_back(std::pow(10.0, -k));
    errors.push_back(error_on(course, registry, [&](RunSettings& s) {
      s.integrator = {"ida"};
      s.tolerance = {tolerances.back(), 1e-2 * tolerances.back()};
    }));
  }
  CAPTURE(course.scene, errors);
  CHECK(slope(tolerances, errors) > 0.8);
  CHECK(slope(tolerances, errors) < 1.2);
  CHECK(errors.back() < 2e-9);
}

// All velocities turned round, a pendulum goes back the way it came. The instant lies within a step, the method begins
// anew there, and the links of the scene are met all the while.
TEST_CASE("ida continues from a state that an event has changed", "[plugin][ida]") {
  System system{System::Options{Vec3(0, -9.81, 0)}};
  Body& bar = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("hinge", bar, system.ground(), pose_at({0, 0, 0}));
  const auto kind = GENERATE(Stabilization::Kind::project, Stabilization::Kind::baumgarte);
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {Formulation::omega, {kind}});
  StepLoop run(dynamics, with_ida().integrators.make("ida", {}, nullptr, "integrator"), {.tolerance = {1e-9, 1e-11}});
  const State start = run.state();
  double turned = 0;
  Event back;
  back.name = "back";
  back.value = [](const Sample& s) { return s.state.q[1] + 0.3; };
  back.change = [&](State& s) { turned = s.t, s.v = -s.v; };
  run.add_event(back);
  run.run_until(1e-3);
  run.run_until(0.5);
  REQUIRE(turned > 0.1);
  REQUIRE(turned < 0.5);
  run.run_until(2 * turned);
  CHECK((run.state().q - start.q).norm() < 2e-8);
  CHECK(run.state().v.norm() < 2e-7);
}

// A method of order k makes an error of h^(k + 1) a step: held against absolute tolerances alone, the number of steps
// goes with tolerance^(-1/(k + 1)).
TEST_CASE("the steps of ida show its order, projected after each of them", "[plugin][ida]") {
  const Registry registry = with_ida();
  const int order = GENERATE(1, 2, 3);
  const auto steps_at = [&](double tolerance) {
    return static_cast<double>(
        run_with_registry(registry, std::string(paths::kScenes) + "/double_pendulum.json", [&](RunSettings& s) {
          s.integrator = {"ida"};
          s.integrator.keys = Value::object({{"max_order", order}});
          s.tolerance = {0, tolerance};
          s.until = 1;
        }).report.steps);
  };
  const double coarse = steps_at(1e-5), fine = steps_at(1e-8);
  CAPTURE(coarse, fine);
  CHECK(std::log(1e3) / std::log(fine / coarse) - 1 == Approx(order).margin(0.3));
}

TEST_CASE("ida runs a function with a constraint out of its plane", "[plugin][ida]") {
  const std::string scene = lockstep::testing::scene_file("ida_slot", R"("gravity": [0, -9.81, 0],
    "bodies": [{"name": "crank", "rod": {"mass": 0.5, "from": [0, 0, 0], "to": [0.1, 0, 0]}},
               {"name": "yoke", "box": {"mass": 2, "size": [0.05, 0.3, 0.02]}, "position": [0.1, 0, 0]}],
    "joints": [{"name": "A", "type": "revolute", "p": "crank", "s": "ground", "at": [0, 0, 0],
                "start": {"velocity": {"rz": 10}}},
               {"name": "guide", "type": "prismatic", "p": "yoke", "s": "ground", "at": [0.1, 0, 0], "axis": "x"},
               {"name": "slot", "type": "function", "p": "crank", "s": "yoke", "at": [0.1, 0, 0], "mask": "z",
                "phi": "=x"}],
    "run": {"until": 0.5, "tolerance": 1e-8, "record": ["A.rz"]})");
  const auto angle = [&](const std::string& method) {
    return run_with_registry(with_ida(), scene, [&](RunSettings& s) { s.integrator = {method}; }).table["A.rz"].back();
  };
  CHECK(angle("ida") == Approx(angle("dopri5")).margin(1e-5));
}

TEST_CASE("a run with checkpoints is rejected before its start if its method cannot be saved", "[plugin][ida]") {
  using lockstep::testing::call, lockstep::testing::contains, lockstep::testing::Called;
  const Called r = call("run '" + std::string(paths::kScenes) + "/flyball.json' --plugin '" + paths::kPlugins +
                        "/ida.so' --integrator ida --until 0.1 --no-picture --record ida.csv --checkpoint "
                        "ida.checkpoint");
  INFO(r.text);
  CHECK(r.exit == 2);
  CHECK(contains(r.text, "--checkpoint: integrator 'ida' keeps a history that cannot be saved"));
}

}  // namespace ida_test
