// The plugin ida: BDF of SUNDIALS on mechanisms, stiff and not.
#include <algorithm>
#include <string>

#include "framework/builtins.h"
#include "framework/plugin/loader.h"
#include "framework/support/error.h"
#include "tests/support/catch.h"
#include "tests/support/course.h"

using namespace lockstep;
using namespace lockstep::test;

namespace {

Registry with_ida() {
  Registry registry = builtin_registry();
  load_plugin(registry, "ida", {paths::kPlugins});
  return registry;
}

}  // namespace

TEST_CASE("the plugin ida brings its integrator and refuses orders that it has not", "[plugin][ida]") {
  const Registry registry = with_ida();
  REQUIRE(registry.integrators.find("ida") != nullptr);
  CHECK(registry.integrators.find("ida")->origin == "ida");
  const auto with_order = [&](int order) {
    return registry.integrators.make("ida", Params{{"max_order", order}}, nullptr, "integrator");
  };
  CHECK(with_order(3)->info().order == 3);
  CHECK(with_order(3)->info().implicit);
  CHECK_THROWS_WITH(with_order(6), Catch::Matchers::Contains("max_order") && Catch::Matchers::Contains("is 6"));
  CHECK_THROWS_AS(with_order(0), SceneError);
}

TEST_CASE("the flyball governor holds to 1e-4 m with ida", "[plugin][ida]") {
  const SceneRun run =
      run_with_registry(with_ida(), std::string(paths::kScenes) + "/flyball.json", [&](RunSettings& s) {
        s.integrator = {"ida"};
        s.tolerance = {1e-7, 1e-9};
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
  CHECK(run.report.steps < 5000);  // stability would ask an explicit method of order 5 for more than 20 000
  CHECK(run.report.largest_violation < 1e-9);
}

// Times of the csv lie inside steps: this is the error of dense output too.
TEST_CASE("the error of ida follows the tolerance with slope one", "[plugin][ida]") {
  const Registry registry = with_ida();
  const Course course = GENERATE(kTopCourse, kDoublePendulumCourse);
  std::vector<double> tolerances, errors;
  for (int k = 4; k <= 9; ++k) {
    tolerances.push_back(std::pow(10.0, -k));
    errors.push_back(error_on(course, registry, [&](RunSettings& s) {
      s.integrator = {"ida"};
      s.tolerance = {tolerances.back(), 1e-2 * tolerances.back()};
    }));
  }
  CAPTURE(course.scene, errors);
  CHECK(slope(tolerances, errors) > 0.8);
  CHECK(slope(tolerances, errors) < 1.2);
  CHECK(errors.back() < 1e-6);
}

// A method of order k makes an error of h^(k + 1) a step, so the number of steps goes with tolerance^(-1/(k + 1)).
TEST_CASE("the steps of ida show its order, projected after each of them", "[plugin][ida]") {
  const Registry registry = with_ida();
  const int order = GENERATE(1, 2, 3);
  const auto steps_at = [&](double tolerance) {
    return static_cast<double>(
        run_with_registry(registry, std::string(paths::kScenes) + "/double_pendulum.json", [&](RunSettings& s) {
          s.integrator = {"ida"};
          s.integrator.keys = Value::object({{"max_order", order}});
          s.tolerance = {tolerance, 1e-2 * tolerance};
          s.until = 1;
        }).report.steps);
  };
  const double coarse = steps_at(1e-4), fine = steps_at(1e-7);
  CAPTURE(coarse, fine);
  CHECK(std::log(1e3) / std::log(fine / coarse) - 1 == Approx(order).margin(0.3));
}
