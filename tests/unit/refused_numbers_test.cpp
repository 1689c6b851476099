// SPDX-License-Identifier: BSD-3-Clause
// States and numbers that cannot be where they are met: what feeds a rate, who reads what, how many unknowns.
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/frame_laws.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/kinematics.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/splines.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/chain.h"
#include "tests/support/messages.h"

namespace refused_numbers_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

/// An integrated state whose rate is no number from 0.2 s on.
class Fed final : public Auxiliary {
 public:
  Fed() : Auxiliary("charge") {}
  int size() const override { return 1; }
  bool reads_solution() const override { return false; }
  void rates(const Evaluated& e, std::span<double> sd) const override {
    sd[0] = e.in.t < 0.2 ? 1 : std::numeric_limits<double>::quiet_NaN();
  }
};

/// A force along x that is no number from 0.3 s on, and puts in what it does.
class Fan final : public Force {
 public:
  Fan() : Force("fan") {}
  std::string_view type() const override { return "test_fan"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { out.force(0, {push(in), 0, 0}, in.slot(0).x); }
  double supply(const Inputs& in) const override { return push(in) * in.slot(0).v[0]; }

 private:
  static double push(const Inputs& in) { return in.t < 0.3 ? 1 : std::numeric_limits<double>::quiet_NaN(); }
};

}  // namespace

TEST_CASE("a force that is no number is itself named, not its power", "[unit][refusals]") {
  System system;
  system.add_particle("bob", 1, {0, 0, 0});
  system.add(std::make_unique<Fan>());
  EnergyAudit audit(system);
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  loop.add_observer(audit);
  const std::string said = message_of<Error>([&] { loop.run_until(1); });
  check_words(said, {"force 'fan'", "is not finite"});
  CHECK_FALSE(lockstep::testing::says(said, {"supply()"}));
}

TEST_CASE("a mass that is no number is reported with its body", "[unit][refusals]") {
  System system(System::Options{{0, 0, -9.81}});
  system.add_body("block", shapes::box(1, {1, 1, 1})).mass.mass = std::numeric_limits<double>::quiet_NaN();
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  const std::string said = message_of<Error>([&] { loop.run_until(1); });
  check_words(said, {"body 'block' has a mass of nan kg"});
  CHECK_FALSE(lockstep::testing::says(said, {"reduce the step"}));
}

TEST_CASE("an integrated state whose rate is no number is reported by name", "[unit][refusals]") {
  for (const Formulation formulation : {Formulation::joint, Formulation::omega}) {
    const std::unique_ptr<System> system = test::chain(2);
    system->add(std::make_unique<Fed>());
    Dynamics dynamics(*system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
    StepLoop loop(dynamics, std::make_unique<Dopri5>());
    check_words(message_of<Error>([&] { loop.run_until(1); }),
                {"the integrated state 'charge' has a rate that is not finite", "check its inputs"});
    CHECK(loop.state().t <= 0.2);
  }
}

TEST_CASE("a motion that laws are to determine has no integrated states besides", "[unit][refusals]") {
  const std::unique_ptr<System> system = test::chain(1);
  static_cast<MarkerLock&>(*system->links()[0]).drive(Axis::rz, laws::sine({.amplitude = 0.5, .omega = 2}));
  system->add(std::make_unique<Fed>());
  Dynamics dynamics(*system, std::make_unique<SchurSolver>());
  State start = system->start();
  assemble(dynamics, start);
  check_words(message_of<ModelError>([&] { DrivenMotion(dynamics, start); }),
              {"not fully prescribed", "'charge' is integrated over time", "use a run, or leave it out"});
}

TEST_CASE("a pose is not set in a state in joint coordinates", "[unit][refusals]") {
  const std::unique_ptr<System> system = test::chain(2);
  Dynamics dynamics(*system, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
  State state = system->start();
  dynamics.to_formulation(state);
  REQUIRE(state.coordinates);
  const VecX before = state.q;
  check_words(message_of<ModelError>([&] { state.set_slot_pose(0, {}); }),
              {"a pose or twist cannot be set", "of the formulation 'joint'", "Dynamics::to_slots"});
  check_words(message_of<ModelError>([&] { state.set_slot_twist(0, {}); }), {"a pose or twist cannot be set"});
  CHECK(state.q == before);
  dynamics.to_slots(state);
  state.set_slot_pose(0, pose_at(Vec3(1, 2, 3)));
  CHECK(state.q.head<3>() == Vec3(1, 2, 3));
}

TEST_CASE("weighted starts of very many bodies are rejected by the number of unknowns", "[unit][refusals]") {
  const std::unique_ptr<System> system = test::chain(251);
  Dynamics dynamics(*system, std::make_unique<SparseSolver>());
  State start = system->start();
  check_words(
      message_of<ModelError>([&] { assemble(dynamics, start, {}, {.poses = {{.body = "rod 0", .weight = 2}}}); }),
      {"at most 1500 unknowns, this mechanism has 1506", "remove them and give poses that fit"});
}

// 2.8 rad in 0.07 s after slow ones: before them the curve of the quaternions swings through zero.
TEST_CASE("a spline of orientations too far apart is rejected with both times", "[unit][refusals]") {
  RotationPoints points;
  for (const auto& [t, angle] :
       {std::pair(0.0, 0.0), std::pair(1.83, 2.28), std::pair(3.4, 3.71), std::pair(3.47, 6.51)})
    points.emplace_back(t, axis_angle(Vec3(1, 0, 0), angle));
  check_words(message_of<ParameterError>([&] { laws::spline_rotation(points); }),
              {"spline_rotation", "points", "rotate too far between 0 s and 1.83 s", "give orientations between them"});
  points.back().first = 5;
  CHECK(message_of<ParameterError>([&] { laws::spline_rotation(points); }) == "no error");
}

}  // namespace refused_numbers_test
