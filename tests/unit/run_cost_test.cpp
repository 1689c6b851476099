// SPDX-License-Identifier: BSD-3-Clause
// What a run asks for beside the rates of its stages: evaluations, motions and values of channels, counted.
#include <cmath>
#include <memory>

#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"

namespace run_cost_test {

using namespace lockstep;

namespace {

/// Two rods on hinges, with angles, reactions and the energy recorded every 0.1 s, by rk4 in steps of 1 ms.
struct Recorded {
  System system{{.gravity = Vec3(0, -9.81, 0)}};
  Body& a = system.add_body("a", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
  Body& b = system.add_body("b", shapes::rod(1.0, Vec3(1, 0, 0), Vec3(2, 0, 0)));
  Lock& A = system.add<Revolute>("A", a, system.ground(), pose_at(Vec3::Zero()));
  Lock& B = system.add<Revolute>("B", b, a, pose_at(Vec3(1, 0, 0)));
  Recorder recorder{system, {"A.rz", "B.rz", "b.angle_z", "A.force_on_p_world_x", "energy.total"}};
  EnergyAudit audit{system, {}};
  Dynamics dynamics;
  StepLoop loop;
  long reads = 0;

  explicit Recorded(Formulation formulation)
      : dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}}),
        loop(dynamics, std::make_unique<Rk4>(), {.step = 1e-3, .output = 0.1}) {
    recorder.add("reads", "", [this](const Sample&) { return static_cast<double>(++reads); });
    loop.add_observer(recorder);
    loop.add_observer(audit);
  }
};

}  // namespace

TEST_CASE("a run evaluates its stages, finds motions once a step, and reads channels at outputs", "[unit][dynamics]") {
  const Formulation formulation = GENERATE(Formulation::joint, Formulation::omega);
  Recorded run(formulation);
  run.loop.run_until(0.1);
  const long evaluations = run.dynamics.work().evaluations, motions = run.dynamics.inputs_read(), reads = run.reads,
             steps = run.loop.report().steps;
  run.loop.run_until(0.6);
  REQUIRE(run.loop.report().steps - steps == 500);
  const long outputs = run.reads - reads;
  CHECK(outputs == 5);
  CHECK(run.dynamics.work().evaluations - evaluations ==
        4 * 500 + outputs);  // reactions are solved for at outputs alone
  CHECK(run.dynamics.inputs_read() - motions == 500);
}

// The law is asked once for each state whose motions are found along the tree. Their end is read for the check of turns.
TEST_CASE("the motions at the end of a step are those of the next first stage", "[unit][dynamics]") {
  System system({.gravity = Vec3(0, -9.81, 0)});
  Body& arm = system.add_body("arm", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
  Body& rod = system.add_body("rod", shapes::rod(1.0, Vec3(1, 0, 0), Vec3(2, 0, 0)));
  long calls = 0;
  system.add<Revolute>("A", arm, system.ground(), pose_at(Vec3::Zero())).drive(Axis::rz, laws::law([&calls](auto t) {
                                                                                 ++calls;
                                                                                 return 0.5 - 0.5 * cos(3.0 * t);
                                                                               }));
  system.add<Revolute>("B", rod, arm, pose_at(Vec3(1, 0, 0)));
  Dynamics dynamics(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 1e-3});
  loop.run_until(0.1);
  const long before = calls, steps = loop.report().steps;
  loop.run_until(0.6);
  REQUIRE(loop.report().steps - steps == 500);
  CHECK(calls - before == 4 * 500 + 1);  // a call of the run forgets what was found before it
}

TEST_CASE("accelerations along a tree cost one evaluation per constraint, and no constraint blocks of joints",
          "[unit][dynamics]") {
  Recorded run(Formulation::joint);
  Recorder rows(run.system, {"B.rz_dd", "b.ax", "b.center_ay"});
  run.loop.add_observer(rows);
  run.loop.run_until(0.1);
  const long evaluations = run.dynamics.work().evaluations;
  run.loop.run_until(0.6);
  CHECK(run.dynamics.work().evaluations - evaluations == 4 * 500 + 5);  // solved for the reactions already
  System tree({.gravity = Vec3(0, -9.81, 0)});
  Body& rod = tree.add_body("rod", shapes::slender_rod(1.0, Vec3::Zero(), Vec3(1, 0, 0), 1e-4));
  tree.add<Revolute>("A", rod, tree.ground(), pose_at(Vec3::Zero()));
  Recorder alone(tree, {"A.rz_dd", "rod.ax"});
  Dynamics dynamics(tree, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 1e-3, .output = 0.1});
  loop.add_observer(alone);
  loop.run_until(0.5);
  CHECK_FALSE(dynamics.holds_rows());
  CHECK(std::abs(alone.table()["A.rz_dd"][0] + 1.5 * 9.81) < 1e-12);
}

TEST_CASE("an audit integrates only works that something does", "[unit][dynamics]") {
  const auto states = [](bool driven, bool damped) {
    System system;
    Body& rod = system.add_body("rod", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
    Revolute& hinge = system.add<Revolute>("A", rod, system.ground(), pose_at(Vec3::Zero()));
    if (driven) hinge.drive(Axis::rz, laws::ramp(1));
    Marker &p = system.add_marker("p", rod), &s = system.add_marker("s", system.ground());
    if (damped) system.add<Bushing>("air", p, s, Bushing::Options{.damping = {4, 0, 0}});
    const EnergyAudit audit(system);
    system.setup();
    return system.n_states();
  };
  CHECK(states(false, false) == 0);
  CHECK(states(true, false) == 1);  // of the drive
  CHECK(states(false, true) == 2);  // supplied, and dissipated
}

}  // namespace run_cost_test
