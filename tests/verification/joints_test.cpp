// SPDX-License-Identifier: BSD-3-Clause
// Joints from functions against trusted histories (tests/verification/data) and closed forms, by their scenes.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace joints_test {

using namespace lockstep;

namespace {

/// Largest difference of a column from f(t), over the whole history.
double off(const Table& t, const char* column, const std::function<double(double)>& f) {
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    if (const double d = std::abs(t[column][i] - f(t["t"][i])); !(d <= worst)) worst = d;
  return worst;
}
void fixed_rk4(RunSettings& run) { run.integrator = {"rk4"}, run.step = 2e-3; }

}  // namespace

// Closed form; 22 turns.
TEST_CASE("a nut moves down its screw as in the closed form", "[verification][joints]") {
  const Table truth = trusted("screw");
  const SceneRun run = run_scene(scene_path("screw"));
  const auto errors = compare(run.table, truth);
  CHECK(errors.size() == truth.columns().size());
  for (const ColumnError& e : errors) {
    CAPTURE(e.name, e.error, e.size);
    CHECK(e.error <= 1e-10 * std::max(1.0, e.size));
  }
}

// Closed forms. Driven: whatever the step.
TEST_CASE("Hooke joints rotate as in their closed forms", "[verification][joints]") {
  const std::string name = GENERATE(as<std::string>(), "hooke_single", "hooke_double");
  const bool rk4 = GENERATE(false, true);
  const Table truth = trusted(name);
  const SceneRun run = run_scene(
      scene_path(name), rk4 ? fixed_rk4 : [](RunSettings&) {});
  const auto errors = compare(run.table, truth);
  CHECK(errors.size() == truth.columns().size());
  for (const ColumnError& e : errors) {
    CAPTURE(name, rk4, e.name, e.error, e.size);
    const bool position = e.name.find("_d") == std::string::npos;
    // a fixed step lets C be what the projection lets be, 1e-10
    CHECK(e.error <= (position ? (rk4 ? 1e-10 : 1e-11) : 1e-9 * std::max(1.0, e.size)));
  }
  if (name == "hooke_double")  // the W arrangement: the same numbers
    for (const char* q : {"", "_d", "_dd"})
      for (const char* shaft : {"mid", "out"}) {
        const std::string ours = std::string("w_") + shaft + q, theirs = std::string("phi_") + shaft + q;
        double worst = 0;
        for (std::size_t i = 0; i < truth.n_rows(); ++i)
          keep_worst(worst, std::abs(run.table[ours.c_str()][i] - truth[theirs.c_str()][i]));
        CAPTURE(ours);
        CHECK(worst <= (*q == 0 ? 1e-11 : 1e-7));
      }
}

// Both stages seen from shaft 1: J = J1 + J2/2^2 + J3/8^2; the tooth multipliers from each shaft's own equation. All
// ways to solve and to integrate.
TEST_CASE("a gear train accelerates with its equivalent inertia", "[verification][joints]") {
  struct Way {
    const char *integrator, *solver;
    double step, tolerance;
  };
  const auto way =
      GENERATE(Way{"dop853", "schur", 0, 1e-10}, Way{"dop853", "dense", 0, 1e-10}, Way{"dop853", "sparse", 0, 1e-10},
               Way{"dop853", "block", 0, 1e-10}, Way{"radau5", "schur", 2e-3, 1e-9},
               Way{"radau5", "sparse", 2e-3, 1e-9}, Way{"generalized_alpha", "schur", 2e-3, 1e-9});
  CAPTURE(way.integrator, way.solver);
  const SceneRun run = run_scene(scene_path("gear_train"), [&](RunSettings& r) {
    r.record.push_back({"stage_1.torque_on_p_world_z", "tooth"}),
        r.record.push_back({"stage_1.torque_on_s_world_z", "carrier"});
    r.integrator = {way.integrator}, r.solver = {way.solver}, r.step = way.step, r.tolerance.relative = way.tolerance;
  });
  const double J1 = 0.5 * 0.4 * 0.02 * 0.02, J2 = 0.5 * 1.6 * 0.04 * 0.04, J3 = 0.016, M = 0.05;
  const double alpha = M / (J1 + J2 / 4 + J3 / 64);
  const Table& t = run.table;
  const auto angle = [&](double by) { return [=](double x) { return 0.5 * by * x * x; }; };
  const auto speed = [&](double by) { return [=](double x) { return by * x; }; };
  const auto steady = [](double by) { return [=](double) { return by; }; };
  CHECK(t["phi_1"].back() > 20 * kTwoPi);
  CHECK(off(t, "phi_1", angle(alpha)) <= 1e-9);
  CHECK(off(t, "phi_2", angle(-alpha / 2)) <= 1e-9);
  CHECK(off(t, "phi_3", angle(-alpha / 8)) <= 1e-9);
  CHECK(off(t, "omega_1", speed(alpha)) <= 1e-9);
  CHECK(off(t, "omega_2", speed(-alpha / 2)) <= 1e-9);
  CHECK(off(t, "omega_3", speed(-alpha / 8)) <= 1e-9);
  CHECK(off(t, "alpha_1", steady(alpha)) <= 1e-9);
  // J1 a1 = M - l1, J3 a3 = 4 l2 (phi_2 = theta_2 - 4 theta_3)
  CHECK(off(t, "lambda_1", steady(M - J1 * alpha)) <= 1e-12);
  CHECK(off(t, "lambda_2", steady(J3 * (-alpha / 8) / 4)) <= 1e-12);
  // what the link does to gear 1; and to the ground, which carries both shafts: T1 + T2 = l (1 + 2)
  CHECK(off(t, "tooth", steady(J1 * alpha - M)) <= 1e-12);
  CHECK(off(t, "carrier", steady(3 * (M - J1 * alpha))) <= 1e-12);
  if (std::string(way.integrator) == "dop853") CHECK(off(t, "balance", steady(0)) <= 1e-12);  // order 2 has less
}

}  // namespace joints_test
