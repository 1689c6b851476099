// SPDX-License-Identifier: BSD-3-Clause
// Accelerations, reactions and branches in singular positions and close to them.
#include <cmath>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/json.h"
#include "framework/description/scene/system_of.h"
#include "framework/description/scene/tree.h"
#include "framework/tools/rank/branch_point.h"
#include "tests/support/catch.h"
#include "tests/support/driven_parallelogram.h"
#include "tests/support/open_defect.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace singular_pose_test {

using namespace lockstep;
using namespace lockstep::testing;

namespace {

constexpr double kG = 9.81;

struct Way {
  std::string integrator;
  Formulation formulation = Formulation::automatic;
  std::string solver = "schur";
  double step = 0, tolerance = 0;  ///< 0: of the scene

  void apply(RunSettings& run) const {
    run.integrator = {integrator}, run.formulation = formulation, run.solver = {solver};
    if (step > 0) run.step = step;
    if (tolerance > 0) run.tolerance = {tolerance, 1e-2 * tolerance};
  }
};

/// The table of a run, or the words of the error that ended it.
struct Ended {
  std::string error;
  Table table;
};
Ended end_of(const std::string& scene, const Way& way) {
  try {
    return {"", run_scene(defect_scene(scene), [&](RunSettings& run) { way.apply(run); }).table};
  } catch (const Error& error) {
    return {error.what(), {}};
  }
}

}  // namespace

// Crank and arm, both of length l, turn evenly against one another, so that for the crank's angle q the slider is at
// 2 l cos q. The moments on the arm about the crank's pin give the force of the guide, with cos q cancelled in every term:
// it is smooth through q = 90 degrees, where the arm by itself leaves it free. The drive's torque is dE/dq.
TEST_CASE("reactions in a singular pose are those on both sides of it", "[verification]") {
  constexpr double l = 0.3, rate = 1.5, crank = 1.5, arm = 2.5, slider = 4;
  const double first = std::atan2(0.11682550269259515, 0.2763182982008655);
  double worst_force = 0, worst_torque = 0;
  for (const Way& way : {Way{"dop853"}, Way{"dop853", Formulation::omega}, Way{"dop853", Formulation::omega, "dense"},
                         Way{"dop853", Formulation::omega, "sparse"}, Way{"radau5", Formulation::omega}}) {
    const Ended ended = end_of("pose_forces", way);
    INFO(way.integrator << ", " << way.solver << ": " << ended.error);
    REQUIRE(ended.table.n_rows() == 7);
    for (std::size_t k = 0; k < 7; ++k) {
      const double t = ended.table["t"][k], q = first + rate * t, force = ended.table["guide"][k];
      const double right = (slider + 0.5 * arm) * kG - (2 * slider + arm) * l * rate * rate * std::sin(q);
      const double torque =
          (std::sin(q) * l * l * rate * rate * (4 * slider + 2 * arm) + 0.5 * kG * l * (crank + arm)) * std::cos(q);
      CAPTURE(t, force, right);
      CHECK(ended.table["slider.x"][k] == Approx(2 * l * std::cos(q)).margin(1e-7));
      CHECK(force == Approx(right).epsilon(1e-7));
      keep_worst(worst_force, std::abs(force - right));
      keep_worst(worst_torque, std::abs(ended.table["T"][k] - torque));
    }
  }
  CAPTURE(worst_force, worst_torque);
  CHECK(worst_force < 1e-5);
  CHECK(worst_torque < 1e-7);
}

// Where the crossed parallelogram lies flat, each rate is a fixed multiple of the first crank's and has an extremum there,
// so that alpha = -V' / I by Lagrange, of the inertia I and the potential V of a turn of that crank.
TEST_CASE("accelerations at a start in a change point are those of the branch that it moves on", "[verification]") {
  struct Part {
    double mass, length, y, turn;  ///< y: rate of the mass centre's height for a turn of the first crank
  };
  const double coupler = -1 / 0.7, right = -0.85 / 0.35;
  const Part parts[] = {
      {0.8, 0.25, 0.125, 1}, {1.1, 0.6, 0.25 + 0.3 * coupler, coupler}, {0.8, 0.25, 0.125 * right, right}};
  double inertia = 0, potential = 0;
  for (const Part& p : parts) {
    inertia += p.mass * (p.y * p.y + p.length * p.length / 12 * p.turn * p.turn);
    potential += p.mass * kG * p.y;
  }
  const double alpha = -potential / inertia;
  const Table table = run_scene(defect_scene("start_in_change_point")).table;
  REQUIRE(table.n_rows() == 6);
  const std::vector<double>&left = table["left.alpha_world_z"], &other = table["right.alpha_world_z"];
  CAPTURE(alpha, left, other, table["Ax"]);
  CHECK(left[0] == Approx(alpha).margin(1e-6));
  CHECK(other[0] == Approx(right * alpha).margin(1e-6));
  CHECK(left[1] == Approx(alpha).margin(1e-3));  // 1e-4 s later
  CHECK(other[1] == Approx(right * alpha).margin(1e-3));
  CHECK(std::isnan(table["Ax"][0]));  // it grows as 1/t towards the start
  CHECK(table["Ax"][1] * 1e-4 == Approx(table["Ax"][2] * 1e-3).epsilon(0.01));
  const Table formulas =
      run_scene(defect_scene("start_in_change_point"), [](RunSettings& run) {
        run.record = {{"=abs(A.force_on_p_world_x)", "size"}, {"=max(abs(A.force_on_p_world_x))", "most"}};
      }).table;
  CHECK(std::isnan(formulas["size"][0]));
  for (std::size_t i = 1; i < table.n_rows(); ++i) CHECK(formulas["size"][i] == Approx(std::abs(table["Ax"][i])));
}

// A four-bar without gravity, whose crank is at rest but for a pulse at 0.437 s. Squares of the accelerations before it
// are no numbers but zero.
TEST_CASE("a pulse that is still far contradicts no constraint", "[verification]") {
  const auto torque = [](const Way& way) {
    const auto settings = [&](RunSettings& run) {
      way.apply(run);
      run.record = {{"A.drive.torque_on_p_link_z", "T"}}, run.draw = {};
    };
    const auto pulse = [](Scene& scene) {
      *member(scene.root, "gravity") = read_json("[0, 0, 0]", "pulse.json");
      Value& drive = *member(member(scene.root, "links")->list()->front(), "drive");
      *member(drive, "law") =
          read_json(R"~({"type": "formula", "y": "=0.1*exp(-((t - 0.437)/0.005)^2)"})~", "pulse.json");
    };
    return run_scene(std::string(paths::kSource) + "/samples/scenes/four_bar.json", settings, pulse).table;
  };
  const Table reference = torque({"dop853", Formulation::omega, "dense"});
  CHECK(std::abs(reference["T"][43]) > 1);
  for (const Formulation formulation : {Formulation::joint, Formulation::omega})
    for (const char* solver : {"schur", "sparse", "block"}) {
      INFO(static_cast<int>(formulation) << " " << solver);
      const Table table = torque({"dop853", formulation, solver});
      REQUIRE(table.n_rows() == reference.n_rows());
      for (std::size_t i = 0; i < table.n_rows(); ++i)
        CHECK(table["T"][i] == Approx(reference["T"][i]).epsilon(1e-6).margin(1e-6));
    }
}

// The uprights of a parallelogram of like rods turn as one: alpha = -2 m g cos(q) / (2 J + m), J about the end of a rod
// whose radius is a fiftieth of its length. At a distance of 1e-3 rad from the flat position, errors of the motion grow a
// thousandfold in it, and by as much again.
TEST_CASE("accelerations near a singular configuration are as accurate as elsewhere", "[verification]") {
  const double per_cosine = 2 * kG / (2 * (1.0 / 3 + 1e-4) + 1);
  double near = 0, away = 0;
  for (const double tolerance : {1e-9, 1e-10}) {
    const SceneRun run =
        run_scene(std::string(paths::kSource) + "/tests/verification/scenes/parallelogram.json", [&](RunSettings& s) {
          s.formulation = Formulation::joint;
          s.tolerance = {tolerance, 1e-2 * tolerance};
          s.until = 4, s.output = 0;
          for (const double passage : {0.708, 1.2148, 2.6321, 3.1389})
            for (int k = -50; k < 50; ++k) s.times.push_back(passage + 4e-5 * k);
          s.times.push_back(3.6), s.times.push_back(4);
          s.record = {{"left.angle_z", ""}, {"left.alpha_world_z", ""}};
        });
    REQUIRE(run.table.n_rows() == 402);
    int n_near = 0;
    for (std::size_t k = 0; k < 402; ++k) {
      const double q = run.table["left.angle_z"][k], off = std::abs(std::remainder(q, kPi));
      const double error = std::abs(run.table["left.alpha_world_z"][k] + per_cosine * std::cos(q));
      if (off > 0.1) keep_worst(away, error);
      if (off < 2e-4 || off > 2e-3) continue;
      keep_worst(near, error), ++n_near;
    }
    CHECK(n_near > 20);
  }
  CAPTURE(near, away);
  CHECK(away < 1e-8);
  CHECK(near < 1e-7);
}

// At 1e-4 rad beside the flat position rounding leaves 1e-1 of a reaction; a spline has no values before its start.
TEST_CASE("reactions near a singular configuration are uncertain at the start of a law, too", "[verification]") {
  const std::string law = GENERATE(as<std::string>(), R"({"type": "ramp", "slope": 3})",
                                   R"({"type": "spline", "points": [[0, 0], [0.2, 0.6], [0.4, 1.2]],
                                       "ends": "natural", "outside": "refuse"})");
  Mechanism m = build_mechanism(
      scene_from_text(driven_parallelogram(1e-4, law, R"("until": 0.2)"), "parallelogram.json"), builtin_registry());
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  State state = m.system.start();
  assemble(dynamics, state, m.start_speeds, m.assembly);
  CHECK(dynamics.solution_at(state).uncertainty > 1e-2);
}

// The flat position is reached after 0.1 s. There nothing determines how A and D share the force along the bars.
TEST_CASE("a multiplier without a value leaves the forces across its direction", "[verification]") {
  Simulation run(build_mechanism(
      scene_from_text(driven_parallelogram(-0.3, R"({"type": "ramp", "slope": 3})",
                                           R"("tolerance": 1e-8, "until": 0.2, "times": [0.099, 0.1, 0.101],
        "record": ["A.lambda_x", "A.force_on_p_world_x", "A.force_on_p_world_y", "A.torque_on_p_world_z"])"),
                      "parallelogram.json"),
      builtin_registry()));
  run.run();
  const Table& table = run.table();
  REQUIRE(table.n_rows() == 3);
  CHECK(std::isnan(table["A.lambda_x"][1]));
  CHECK(std::isnan(table["A.force_on_p_world_x"][1]));
  const std::vector<double>& across = table["A.force_on_p_world_y"];
  CHECK(across[1] == Approx(0.5 * (across[0] + across[2])).epsilon(1e-3));
}

// To first order each hinge between moves across, and all that do lengthen the chain.
TEST_CASE("a stretched chain cannot move, which is reported with three motions and not more", "[verification]") {
  const int n = GENERATE(2, 4, 5);
  const double l = GENERATE(1.0, 1e-3, 1e4);
  System system;
  Body* before = &system.ground();
  for (int k = 0; k < n; ++k) {
    const std::string number = std::to_string(k);
    Body& rod = system.add_body("rod " + number, shapes::rod(1, Vec3(k * l, 0, 0), Vec3((k + 1) * l, 0, 0)));
    system.add<Revolute>("hinge " + number, rod, *before, pose_at(Vec3(k * l, 0, 0)));
    before = &rod;
  }
  system.add<Revolute>("end", *before, system.ground(), pose_at(Vec3(n * l, 0, 0)));
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {Formulation::omega, {}});
  dynamics.set_up();
  const BranchPoint at = branch_point(dynamics, system.start());
  CAPTURE(n, l);
  CHECK(at.singular);
  CHECK(at.motions == n - 1);
  CHECK(at.tangents.empty());
  CHECK(at.all == (n <= 4));
  CHECK(at.locked == (n == 2));
}

}  // namespace singular_pose_test
