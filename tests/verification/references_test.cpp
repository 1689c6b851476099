// SPDX-License-Identifier: BSD-3-Clause
// Every reference mechanism that has a scene, against its trusted history (tests/verification/data, sources in the
// README there).
#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace references_test {

using namespace lockstep;

namespace {

struct Reference {
  std::string scene, csv;
  std::vector<std::string> unrecorded;  // columns of the csv that the scene does not record, and why (below)
};

/// Every column of the csv is recorded, but for those named; then the errors.
std::vector<ColumnError> errors_of(const Reference& r, const std::function<void(RunSettings&)>& change = {}) {
  const SceneRun run = run_scene(scene_path(r.scene), change);
  const Table truth = trusted(r.csv);
  for (const Column& c : truth.columns())
    if (std::find(r.unrecorded.begin(), r.unrecorded.end(), c.name) == r.unrecorded.end()) {
      INFO("column " << c.name);
      CHECK(run.table.has(c.name));
    }
  return compare(run.table, truth);
}

}  // namespace

// At tolerance 1e-10 with dop853 the worst column over the whole history is within 1e-8 (m, rad, or of the column's
// size).
TEST_CASE("free-running references hold to 1e-8 over the whole history", "[verification][references]") {
  const auto r = GENERATE(
      Reference{"rod_pendulum", "rod_pendulum", {}},
      Reference{"a01_pendulum", "a01_pendulum", {"phi", "phi_d", "phi_dd"}},  // a particle has no angle
      Reference{"double_pendulum", "double_pendulum", {}}, Reference{"chain_10", "chain_10", {}},
      Reference{"spatial_chain_10_tilted", "spatial_chain_10_tilted", {}},
      Reference{"spatial_chain_10", "spatial_chain_10", {}}, Reference{"heavy_top", "heavy_top", {}},
      Reference{"gyroscope_steady", "gyroscope_steady", {}},
      Reference{"free_body", "free_body", {"Fx", "Fy", "Fz"}},  // no joint, no force
      Reference{"mass_spring_damper", "mass_spring_damper", {"x_c", "v_c"}},
      Reference{"mass_spring_damper_fast", "mass_spring_damper", {"x_a", "v_a", "x_b", "v_b"}},
      Reference{"moving_marker_ground", "moving_marker_ground", {}},
      Reference{"moving_marker_free", "moving_marker_free", {"u_dd", "f", "f_d", "f_dd"}},  // the laws themselves
      Reference{"sliding_block", "sliding_block", {}}, Reference{"bouncing_pendulum", "bouncing_pendulum", {}},
      Reference{"andrews_ivp", "andrews_ivp", {"energy_balance", "torque_check"}});
  const Formulation formulation = GENERATE(Formulation::omega, Formulation::automatic);
  CAPTURE(r.scene, to_string(formulation));
  for (const ColumnError& e : errors_of(r, [&](RunSettings& s) { s.formulation = formulation; })) {
    CAPTURE(e.name, e.error, e.size);
    CHECK(e.error <= 1e-8 * std::max(1.0, e.size));
  }
}

// Driven mechanisms hold to 1e-10 m (rad) whatever the step, reactions to 1e-8 of their size.
TEST_CASE("driven references agree to 1e-10 at every step size", "[verification][references]") {
  const auto r =
      GENERATE(Reference{"slider_crank", "slider_crank", {"drive_torque_by_power"}},
               Reference{"four_bar", "four_bar", {"drive_torque_by_power"}}, Reference{"oldham", "oldham", {}},
               Reference{"prismatic_law", "prismatic_law", {}}, Reference{"robot_arm", "robot_arm", {}});
  const double step = GENERATE(1e-2, 1e-3);
  const std::vector<std::string> positions = {"theta", "phi", "xs", "coupler", "rocker", "phi_in", "phi_out",
                                              "xd",    "yd",  "s",  "xc",      "yc",     "q1",     "q2",
                                              "q3",    "q4",  "q5", "q6",      "tipx",   "tipy",   "tipz"};
  const auto errors = errors_of(r, [&](RunSettings& run) {
    run.integrator = {"rk4"};
    run.step = step;
  });
  CAPTURE(r.scene, step);
  for (const ColumnError& e : errors) {
    CAPTURE(e.name, e.error, e.size);
    const bool position = std::find(positions.begin(), positions.end(), e.name) != positions.end();
    CHECK(e.error <= (position ? 1e-10 : 1e-8 * std::max(e.size, position ? 1.0 : 1e-3)));
  }
}

// Closed form: R_out = Rz(beta(t)) Rx(phi(t)), beta = 0.4 sin 3t, phi = 2 pi t.
TEST_CASE("the homokinetic joint rotates both shafts equally at every bend", "[verification][references]") {
  const SceneRun run = run_scene(scene_path("homokinetic"));
  const Table& t = run.table;
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double beta = 0.4 * std::sin(3 * t["t"][i]), phi = kTwoPi * t["t"][i];
    const Quat exact = axis_angle(Vec3::UnitZ(), beta) * axis_angle(Vec3::UnitX(), phi);
    const Vec4 ours(t["qw"][i], t["qx"][i], t["qy"][i], t["qz"][i]), q = exact.coefficients();
    keep_worst(worst, std::min((ours - q).norm(), (ours + q).norm()));
    keep_worst(worst, std::abs(t["phi_out"][i] - phi));
  }
  CHECK(t.n_rows() == 201);
  CHECK(worst < 1e-10);
}

}  // namespace references_test
