// SPDX-License-Identifier: BSD-3-Clause
// Stiff mechanisms: what implicit methods hold where explicit ones blow up, and what those then say.
#include <algorithm>
#include <cmath>
#include <string>

#include <lockstep/error.h>
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace stiff_test {

using namespace lockstep;

namespace {

SceneRun run_flyball(const std::string& method, double step, double tolerance) {
  return run_scene(scene_path("flyball"), [&](RunSettings& s) {
    s.integrator = {method};
    if (method.starts_with("dop")) s.integrator.keys = Value::object({{"fixed", true}});
    s.step = step;
    if (tolerance > 0) s.tolerance = {tolerance, 1e-2 * tolerance};
  });
}

}  // namespace

TEST_CASE("the flyball governor holds to 1e-6 m with radau5", "[verification][stiff]") {
  const SceneRun run = run_flyball("radau5", 0, 1e-6);
  for (const ColumnError& e : compare(run.table, trusted("flyball"))) {
    CAPTURE(e.name, e.error, e.size);
    if (e.name == "s" || e.name == "alpha" || e.name == "spring_length") CHECK(e.error < 1e-6);
    if (e.name == "psi") CHECK(e.error < 1e-5);  // adds up over nine turns
  }
  CHECK(run.report.steps < 2000);  // stability would ask an explicit method of order 5 for more than 20 000
}

TEST_CASE("the flyball governor holds to 1e-4 m with generalized_alpha at a millisecond", "[verification][stiff]") {
  const SceneRun run = run_flyball("generalized_alpha", 1e-3, 0);
  for (const ColumnError& e : compare(run.table, trusted("flyball"))) {
    CAPTURE(e.name, e.error, e.size);
    if (e.name == "s" || e.name == "alpha" || e.name == "spring_length") CHECK(e.error < 1e-4);
  }
}

TEST_CASE("explicit methods become unstable on the flyball governor at a millisecond and report it",
          "[verification][stiff]") {
  const std::string method = GENERATE("semi_implicit_euler", "rk4", "dopri5", "dop853");
  CAPTURE(method);
  double t = -1;
  std::string message;
  try {
    run_flyball(method, 1e-3, 0);
  } catch (const StepError& e) {
    t = e.t, message = e.what();
  } catch (const NonFiniteError& e) {
    t = e.t, message = e.what();
  }
  CAPTURE(message);
  CHECK(t >= 0);
  CHECK(t < 1);
  CHECK(message.find("t = ") != std::string::npos);
  CHECK(message.find("radau5") != std::string::npos);
}

// Error at the end against the tolerance: a line of slope one from 1e-4 to 1e-9 m.
TEST_CASE("the error of radau5 on the flyball governor follows the tolerance", "[verification][stiff]") {
  const Table truth = trusted("flyball");
  const auto error_of = [&](double tolerance) {
    const SceneRun run = run_flyball("radau5", 0, tolerance);
    double worst = 0;
    for (const ColumnError& e : compare(run.table, truth))
      if (e.name == "s" || e.name == "alpha") keep_worst(worst, e.error);
    return worst;
  };
  const double loose = error_of(1e-4), tight = error_of(1e-8);
  const double slope = std::log10(loose / tight) / 4;
  CAPTURE(loose, tight, slope);
  CHECK(slope > 0.8);
  CHECK(slope < 1.45);
  CHECK(tight < 1e-9);
}

TEST_CASE("Andrews' mechanism A03 holds to 1e-7 with radau5", "[verification][stiff]") {
  const SceneRun run = run_scene(scene_path("andrews_a03"));
  const Table truth = trusted("andrews_a03");
  for (const Column& c : truth.columns())
    if (c.name != "energy_balance" && c.name != "torque_check") {
      INFO("column " << c.name);
      CHECK(run.table.has(c.name));
    }
  for (const ColumnError& e : compare(run.table, truth)) {
    CAPTURE(e.name, e.error, e.size);
    CHECK(e.error <= 1e-7 * std::max(1.0, e.size));
  }
}

}  // namespace stiff_test
