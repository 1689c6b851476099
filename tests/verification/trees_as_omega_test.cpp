// SPDX-License-Identifier: BSD-3-Clause
// Where joint coordinates could be the worse ones: joints of several coordinates with slender bars and heavy ends, and
// bodies that laws move beside others that are free. Against omega and closed forms.
#include <cmath>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/body.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/random_bodies.h"
#include "tests/support/worst.h"

namespace trees_as_omega_test {

using namespace lockstep;
using testing::accelerations, testing::largest;

namespace {

constexpr double kG = 9.81;

Dynamics dynamics_of(System& system, Formulation formulation) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
}

State start_of(Dynamics& dynamics) {
  State start = dynamics.system().start();
  assemble(dynamics, start);
  return start;
}

/// Rods of 1 kg and 1 m end to end along x, each on a ball; the last weighs `load`.
System bars(int n, double load, double slender = 0.01) {
  System system({.gravity = Vec3(0, -kG, 0.3)});
  Body* last = &system.ground();
  for (int i = 0; i < n; ++i) {
    const std::string k = std::to_string(i);
    const double m = i + 1 < n ? 1.0 : load;
    Body& rod = system.add_body("rod" + k, {m, Vec3::Zero(), (m * Vec3(slender, 1.0 / 12, 1.0 / 12)).asDiagonal()},
                                {Vec3(i + 0.5, 0, 0), {}});
    system.add<Spherical>("ball" + k, rod, *last, pose_at(Vec3(i, 0, 0), Vec3(0.3, 1, 0.2)));
    last = &rod;
  }
  return system;
}

/// A pendulum of 1 kg and 1 m, and apart from it a hinge about the vertical that a law swings, 1 rad at 60 rad/s.
System beside() {
  System system({.gravity = Vec3(0, 0, -kG)});
  Body& arm = system.add_body("arm", {2.0, Vec3::Zero(), Vec3(0.1, 0.2, 0.3).asDiagonal()}, {Vec3(3, 0, 0), {}});
  Body& bob = system.add_body("bob", {1.0, Vec3::Zero(), Vec3(0.01, 0.1, 0.1).asDiagonal()}, {Vec3(1, 0, 0), {}});
  system.add<Revolute>("pin", bob, system.ground(), pose_at(Vec3::Zero(), Vec3(0, 1, 0)));
  system.add<Revolute>("hinge", arm, system.ground(), pose_at(Vec3(2.5, 0, 0)))
      .drive(Axis::rz, laws::sine({.amplitude = 1, .omega = 60}));
  return system;
}

template <class Method>
SimulationReport run(System& system, Formulation formulation, Tolerance tolerance, double until,
                     Recorder* recorder = nullptr) {
  Dynamics dynamics = dynamics_of(system, formulation);
  StepLoop loop(dynamics, std::make_unique<Method>(), {.tolerance = tolerance, .output = until / 20});
  loop.set_state(start_of(dynamics));
  if (recorder) loop.add_observer(*recorder);
  loop.run_until(until);
  CHECK((loop.state().coordinates != nullptr) == (formulation != Formulation::omega));
  return loop.report();
}

}  // namespace

TEST_CASE("bars on balls rotate about their axes as exactly as in omega, with every load on them",
          "[verification][joint]") {
  const auto [n, load] =
      GENERATE(std::pair(1, 1.0), std::pair(3, 1.0), std::pair(10, 1.0), std::pair(30, 1.0), std::pair(4, 1000.0));
  CAPTURE(n, load);
  System system = bars(n, load);
  Dynamics joint = dynamics_of(system, Formulation::joint), omega = dynamics_of(system, Formulation::omega);
  State state = system.start();
  joint.to_formulation(state);
  testing::Draw draw(7);
  for (Eigen::Index i = 0; i < state.q.size(); ++i) state.q[i] += draw.number(-0.3, 0.3);
  state.coordinates->normalize(state);
  for (Eigen::Index i = 0; i < state.v.size(); ++i) state.v[i] = draw.number(-1, 1);
  StateRate rate;
  joint.rates(state, rate);
  const VecX a = accelerations(joint, state, rate);
  joint.to_slots(state);
  const VecX expected = accelerations(omega, state);
  CHECK(largest(a - expected) < 1e-10 * largest(expected));
}

TEST_CASE("bars on balls take the steps that they take in omega", "[verification][joint]") {
  const auto [n, load, tolerance] = GENERATE(std::tuple(4, 1000.0, 1e-6), std::tuple(6, 1.0, 1e-10));
  CAPTURE(n, load);
  System system = bars(n, load);
  const SimulationReport joint = run<Dop853>(system, Formulation::joint, {tolerance, 0.01 * tolerance}, 0.5),
                         omega = run<Dop853>(system, Formulation::omega, {tolerance, 0.01 * tolerance}, 0.5);
  CHECK(joint.steps < 1.2 * omega.steps + 5);
}

TEST_CASE("if the rotation of a slender bar is a rounding error of its load omega runs, and reports why",
          "[verification][joint]") {
  System slender = bars(4, 1000, 1e-4), stout = bars(4, 1000);
  const auto why = [](System& system, Formulation formulation) {
    return dynamics_of(system, formulation).why_not_joint(system.start().modes);
  };
  testing::check_words(why(slender, Formulation::automatic),
                       {"body 'rod", "least inertia of 0.0001 kg m^2", "carries 1e+03 kg", "arms of 0.5 m"});
  CHECK(why(slender, Formulation::joint) == "");
  CHECK(why(stout, Formulation::automatic) == "");
}

TEST_CASE("steps that rounding keeps short in joint coordinates are reported with the body and the tolerance",
          "[verification][joint]") {
  const double tolerance = 1e-12;
  const auto ending = [&](Formulation formulation) {
    System system = bars(4, 1000, 1e-5);
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::make_unique<Dop853>(),
                  {.tolerance = {tolerance, 0.01 * tolerance}, .output = 0.1, .max_steps = 10100});
    loop.set_state(start_of(dynamics));
    return testing::message_of<StepError>([&] { loop.run_until(0.2); });
  };
  testing::check_words(
      ending(Formulation::joint),
      {"the rest of the run would take", "the tolerance of 1e-12 is below the round-off in joint coordinates", "body 'rod",
       "least inertia of 1e-05 kg m^2", "use formulation omega, or a larger tolerance"});
  CHECK(ending(Formulation::omega) == "no error");
}

TEST_CASE("bodies moved by laws in a partly free mechanism have the errors that they have in omega",
          "[verification][joint]") {
  System system = beside();
  const SimulationReport omega = run<Dopri5>(system, Formulation::omega, {1e-6, 1e-8}, 1);
  Recorder recorder(system, {"hinge.drive.work"});
  const SimulationReport joint = run<Dopri5>(system, Formulation::automatic, {1e-6, 1e-8}, 1, &recorder);
  CHECK(joint.steps > 0.5 * omega.steps);
  CHECK(joint.steps < 1.2 * omega.steps);
  // 1/2 (J + m r^2) (theta'^2 - theta'_0^2) about the vertical: J = 0.3, m = 2, r = 0.5
  const Table t = recorder.table();
  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double rate = 60 * std::cos(60 * 0.05 * static_cast<double>(i));
    keep_worst(worst, std::abs(t["hinge.drive.work"][i] - 0.5 * 0.8 * (rate * rate - 3600)));
  }
  CHECK(worst < 1e-4 * 1440);
}

// A flat parallelogram starts in a singular position: its first stage is found from both sides.
TEST_CASE("bodies moved by laws near a singular start hinder no step", "[verification][joint]") {
  System system({.gravity = Vec3(0, -kG, 0)});
  const auto rod = [&](const char* name, const Vec3& middle, const Vec3& velocity, double w) -> Body& {
    Body& body = system.add_body(name, {1.0, Vec3::Zero(), Vec3(0.01, 1.0 / 12, 1.0 / 12).asDiagonal()}, {middle, {}});
    body.start = {velocity, Vec3(0, 0, w)};
    return body;
  };
  Body &left = rod("left", Vec3(0.5, 0, 0), Vec3(0, 1.5, 0), 3),
       &right = rod("right", Vec3(2.5, 0, 0), Vec3(0, 1.5, 0), 3), &bar = rod("bar", Vec3(2, 0, 0), Vec3(0, 3, 0), 0);
  system.add<Revolute>("A", left, system.ground(), pose_at(Vec3(0, 0, 0)));
  system.add<Revolute>("B", right, system.ground(), pose_at(Vec3(2, 0, 0)));
  system.add<Revolute>("C", bar, left, pose_at(Vec3(1, 0, 0)));
  system.add<Revolute>("D", bar, right, pose_at(Vec3(3, 0, 0)));
  Body& arm = rod("arm", Vec3(0, 5, 0), Vec3::Zero(), 0);
  system.add<Revolute>("hinge", arm, system.ground(), pose_at(Vec3(0, 5, 0)))
      .drive(Axis::rz, laws::polynomial({0.0, 3.0}));
  const Tolerance tolerance{1e-8, 1e-10};
  const SimulationReport joint = run<Dop853>(system, Formulation::joint, tolerance, 0.5),
                         omega = run<Dop853>(system, Formulation::omega, tolerance, 0.5);
  CHECK(joint.steps < 2 * omega.steps + 20);
}

TEST_CASE("a condition on a body moved by laws in a partly free mechanism is met at the time of its closed form",
          "[verification][joint]") {
  System system = beside();
  const Channel angle = make_channel(system, "hinge.rz");
  Dynamics dynamics = dynamics_of(system, Formulation::automatic);
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  loop.set_state(start_of(dynamics));
  loop.add_event({.name = "high", .value = [&](const Sample& s) { return angle.value(s) - 0.99; }, .stop = true});
  loop.run_until(1);
  CHECK(loop.state().t == Approx(std::asin(0.99) / 60).epsilon(1e-6));
}

}  // namespace trees_as_omega_test
