// SPDX-License-Identifier: BSD-3-Clause
// The plugin odeint: a foreign explicit method, its order and its error against the tolerance.
#include <string>

#include <lockstep/author/loader.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/course.h"
#include "tests/support/run_scene.h"

namespace odeint_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {

Registry with_odeint() {
  Registry registry = builtin_registry();
  load_plugin(registry, "odeint", {paths::kPlugins});
  return registry;
}

}  // namespace

TEST_CASE("the plugin odeint adds its integrator and reports its origin", "[plugin][odeint]") {
  const Registry registry = with_odeint();
  REQUIRE(registry.integrators.find("odeint_cash_karp54") != nullptr);
  CHECK(registry.integrators.find("odeint_cash_karp54")->origin == "odeint");
  const IntegratorInfo info = registry.integrators.make("odeint_cash_karp54", {}, nullptr, "integrator")->info();
  CHECK(info.order == 5);
  CHECK(info.adaptive);
  CHECK_FALSE(info.implicit);
}

TEST_CASE("the error of odeint's method follows the step with order 5", "[plugin][odeint]") {
  const Registry registry = with_odeint();
  const auto order = [&](const Course& course, double n0, double n1) {
    const auto error_at = [&](double n) {
      return error_on(course, registry, [&](RunSettings& s) {
        s.integrator = {"odeint_cash_karp54"};
        s.integrator.keys = Value::object({{"fixed", true}});
        s.step = course.end / n;
        s.output = 0, s.times = {course.end};
        s.stabilization.tolerance = 1e-13;
      });
    };
    return -slope({n0, n1}, {error_at(n0), error_at(n1)});
  };
  CHECK(order(kTopCourse, 400, 800) == Approx(5).margin(0.15));
  CHECK(order(kDoublePendulumCourse, 100, 200) == Approx(5).margin(0.15));
}

TEST_CASE("the error of odeint's method follows the tolerance with slope one", "[plugin][odeint]") {
  const Registry registry = with_odeint();
  const Course course = GENERATE(kTopCourse, kDoublePendulumCourse);
  std::vector<double> tolerances, errors;
  for (int k = 4; k <= 10; k += 2) {
    tolerances.push_back(std::pow(10.0, -k));
    errors.push_back(error_on(course, registry, [&](RunSettings& s) {
      s.integrator = {"odeint_cash_karp54"};
      s.tolerance = {tolerances.back(), 1e-2 * tolerances.back()};
    }));
  }
  CAPTURE(course.scene, errors);
  CHECK(slope(tolerances, errors) > 0.9);
  CHECK(slope(tolerances, errors) < 1.3);  // the weights are increments, which shrink with the step
  CHECK(errors.back() < 1e-7);
}

TEST_CASE("odeint's method with too long a step ends with a word of advice", "[plugin][odeint]") {
  const Registry registry = with_odeint();
  std::string message;
  try {
    run_with_registry(registry, scene_path("flyball"), [](RunSettings& s) {
      s.integrator = {"odeint_cash_karp54"};
      s.integrator.keys = Value::object({{"fixed", true}});
      s.step = 1e-3;
    });
  } catch (const StepError& e) {
    message = e.what();
  } catch (const NonFiniteError& e) {
    message = e.what();
  }
  CAPTURE(message);
  CHECK(message.find("radau5") != std::string::npos);
}

}  // namespace odeint_test
