// SPDX-License-Identifier: BSD-3-Clause
// Simulation, the facade: what it resolves by name is what the layers below it are made of.
#include <lockstep/simulation.h>

#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include "tests/support/messages.h"

namespace short_way_test {

using namespace lockstep;
using lockstep::testing::message_of;
using lockstep::testing::says;

namespace {

System pendulum() {
  System system({.gravity = {0, -9.81, 0}});
  Body& bar = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  system.add<Revolute>("hinge", bar, system.ground(), pose_at({0, 0, 0}));
  return system;
}

}  // namespace

TEST_CASE("A simulation by names is the run that its layers make, to the last bit", "[simulation]") {
  System one = pendulum(), other = pendulum();
  Simulation run(one, {.integrator = "dopri5", .tolerance = 1e-8, .output = 0.01});
  const Table& table = run.record({"rod.angle_z", {"Fy", "hinge.force_on_p_world_y"}, "energy.total"});
  run.run_until(1.0);

  Recorder recorder(other, {"rod.angle_z", {"Fy", "hinge.force_on_p_world_y"}, "energy.total"});
  Dynamics dynamics(other, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Dopri5>(), {.tolerance = {1e-8, 1e-10}, .output = 0.01});
  loop.add_observer(recorder);
  loop.run_until(1.0);

  REQUIRE(table.n_rows() == 101);
  REQUIRE(recorder.table().n_rows() == 101);
  for (const char* name : {"rod.angle_z", "Fy", "energy.total"}) CHECK(table[name] == recorder.table()[name]);
  CHECK(run.state().t == 1.0);
}

// Free fall from 2 m: v = g t, and v^2/2 + g z = 2 g.
TEST_CASE("A column may be a function of the state", "[simulation]") {
  System system({.gravity = {0, 0, -9.81}});
  const Body& stone = system.add_particle("stone", 1, {0, 0, 2});
  Simulation run(system, {.output = 0.05});
  const auto motion = [&](const Sample& s) -> const Motion& { return s.inputs().slot(stone.slot); };
  const Table& table = run.record(
      "speed", [=](const Sample& s) { return motion(s).v.norm(); }, "m/s");
  run.record("total", [=](const Sample& s) { return 0.5 * motion(s).v.squaredNorm() + 9.81 * motion(s).x[2]; });
  testing::check_words(message_of<ModelError>([&] { run.record("none", nullptr); }), {"\"none\" has no function"});
  CHECK_THROWS_AS(run.record("speed", [](const Sample&) { return 0.0; }), ModelError);
  run.run_until(0.5);
  CHECK(table.column("speed").unit == "m/s");
  CHECK(table.column("total").unit.empty());
  REQUIRE(table.n_rows() == 11);
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    CHECK(std::abs(table["speed"][i] - 9.81 * table["t"][i]) < 1e-12);
    CHECK(std::abs(table["total"][i] - 2 * 9.81) < 1e-12);
  }
  testing::check_words(message_of<ModelError>([&] { run.record("late", [](const Sample&) { return 0.0; }); }),
                       {"after the start of the run"});
}

TEST_CASE("A simulation with a named solver runs in omega", "[simulation]") {
  System by_itself = pendulum(), told = pendulum(), turned = pendulum();
  const auto in_joints = [](System& system, SimulationOptions options) {
    Simulation run(system, std::move(options));
    run.run_until(0.1);
    return run.state().coordinates != nullptr;
  };
  CHECK(in_joints(by_itself, {}));
  for (const char* solver : {"dense", "schur"}) {
    System own = pendulum();
    CAPTURE(solver);
    CHECK_FALSE(in_joints(own, {.solver = solver}));
  }
  CHECK(in_joints(told, {.solver = "dense", .dynamics = {.formulation = Formulation::joint, .stabilization = {}}}));
  Simulation run(turned, {.dynamics = {.formulation = Formulation::quaternion, .stabilization = {}}});
  CHECK(run.dynamics().solver().name() == "sparse");  // as of a scene: the default needs six velocities per body
}

TEST_CASE("A simulation assembles its start, or rejects it if assembly is off", "[simulation]") {
  System system = pendulum();
  system.setup();
  State start = system.start();
  start.q[0] += 1e-3;  // m, off the hinge
  {
    Simulation run(system);
    run.set_state(start);
    CHECK(run.assembly().before == Approx(1e-3).epsilon(1e-6));
    CHECK(run.assembly().after < 1e-12);
    run.run_until(0.1);
    CHECK(run.state().t == 0.1);
  }
  Simulation run(system, {.assemble = false});
  testing::check_words(message_of<AssemblyError>([&] { run.set_state(start); }), {"hinge", "0.001"});
}

TEST_CASE("A body or joint is rejected while a run of its system exists", "[simulation]") {
  System system = pendulum();
  Body& rod = system.body("rod");
  {
    Simulation run(system);
    run.run_until(0.1);
    CHECK(message_of<ModelError>([&] {
            system.add_particle("late", 1, {0, 0, 0});
          }) == "body 'late': the run of its system has begun; add it before the run, or build the system again");
    CHECK(
        says(message_of<ModelError>([&] { system.add<Revolute>("late", rod, system.ground(), pose_at(Vec3::Zero())); }),
             {"joint 'late': the run of its system has begun"}));
    run.run_until(0.2);
  }
  system.add_particle("later", 1, {0, 0, 0});
}

TEST_CASE("A simulation rejects impossible settings, with the next move", "[simulation]") {
  System system = pendulum();
  CHECK(says(message_of<Error>([&] { Simulation bad(system, {.integrator = "dopri"}); }), {"did you mean \"dopri5\""}));
  CHECK(says(message_of<Error>([&] { Simulation bad(system, {.integrator = "dop853:stage=auto"}); }), {"did you mean \"stages\""}));
  CHECK(says(message_of<Error>([&] { Simulation bad(system, {.solver = "shur"}); }), {"did you mean \"schur\""}));
  CHECK(says(message_of<Error>([&] { Simulation bad(system, {.integrator = "rk4"}); }), {"none is given; set .step"}));
  CHECK(says(message_of<Error>([&] { Simulation bad(system, {.tolerance = 0}); }), {"it must be greater than 0"}));
  Simulation run(system, {.integrator = "rk4", .step = 1e-3});
  run.run_until(0.01);
  CHECK(run.loop().report().steps == 10);
  CHECK(says(message_of<Error>([&] { run.record({"rod.x"}); }), {"call it directly after the Simulation is made"}));
}

}  // namespace short_way_test
