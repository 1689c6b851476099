// What a run asks for beside the rates of its stages: evaluations, motions and values of channels, counted.
#include <cmath>
#include <memory>

#include <lockstep/integrators.h>
#include <lockstep/joints.h>
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
  Recorder recorder{system, {"A.angle_z", "B.angle_z", "b.angle_z", "A.force_on_p_world_x", "energy.total"}};
  EnergyAudit audit{system, {}};
  Dynamics dynamics;
  StepLoop loop;
  long reads = 0;

  explicit Recorded(Formulation formulation)
      : dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation}),
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

}  // namespace run_cost_test
