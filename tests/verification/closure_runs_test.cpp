// SPDX-License-Identifier: BSD-3-Clause
// Runs of loops in joint coordinates: against omega, through flat positions, with looks aside; what a step allocates.
#include <cmath>

#include <lockstep/assembly.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/author/registry.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/loops.h"
#include "tests/support/random_bodies.h"
#include "tests/support/run_scene.h"

namespace closure_runs_test {

using namespace lockstep;
using loops::joint_dynamics, loops::row_of_four_bars;
using testing::largest;

TEST_CASE("a loop with a driven closing joint moves in joint coordinates as in omega, with Baumgarte stabilisation too",
          "[verification][joint]") {
  const auto run = [](Formulation formulation, Stabilization::Kind kind, Plane plane, double& work, double& drift) {
    System s({.gravity = Vec3(0, -9.81, 0)});
    s.set_planar(plane);
    const auto rod = [&](const std::string& name, const Vec3& from, const Vec3& to) -> Body& {
      return s.add_body(name, shapes::rod(1.0, from, to));
    };
    Body &crank = rod("crank", {0, 0, 0}, {0, 0.4, 0}), &coupler = rod("coupler", {0, 0.4, 0}, {1, 0.8, 0}),
         &rocker = rod("rocker", {1, 0.8, 0}, {1, 0, 0});
    s.add<Revolute>("A", crank, s.ground(), pose_at(Vec3(0, 0, 0)));
    s.add<Revolute>("B", coupler, crank, pose_at(Vec3(0, 0.4, 0)));
    auto& closing = s.add<Revolute>("D", rocker, s.ground(), pose_at(Vec3(1, 0, 0)));
    s.add<Spherical>("C", rocker, coupler, pose_at(Vec3(1, 0.8, 0)));
    closing.drive(Axis::rz, laws::polynomial({0.0, 0.0, 0.5}));
    Recorder recorder(s);
    recorder.add(make_channel(s, "D.drive.work"));
    Stabilization stabilization{kind};
    Dynamics dynamics(s, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = stabilization});
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-11, 1e-11}});
    State start = s.start();
    assemble(dynamics, start);
    loop.set_state(start);
    loop.run_until(0.5);
    State end = loop.state();
    work = end.s[0], drift = dynamics.violation(end);
    CHECK((end.coordinates != nullptr) == (formulation == Formulation::joint));
    dynamics.to_slots(end);
    return end;
  };
  for (const int plane : {-1, 2})
    for (const Stabilization::Kind kind : {Stabilization::Kind::project, Stabilization::Kind::baumgarte}) {
      CAPTURE(plane, kind);
      double work = 0, expected = 0, drift = 0, omega_drift = 0;
      const State joint = run(Formulation::joint, kind, Plane{plane}, work, drift),
                  omega = run(Formulation::omega, kind, Plane{plane}, expected, omega_drift);
      CHECK(largest(joint.v - omega.v) < 1e-8);
      CHECK(std::abs(work - expected) < 1e-8);
      CHECK(std::abs(expected) > 0.01);
      CHECK(drift < 1e-9);
    }
}

// Its rows are independent: a solution meets them to rounding, but for one here and there. A correction of each, 12 in a
// step, would leave the motion as it is and only take time.
TEST_CASE("a driven loop in the plane needs less than a correction in a step", "[verification][joint]") {
  enum class DrivenAt { tree, closing, telescope };
  for (const DrivenAt at : {DrivenAt::tree, DrivenAt::closing, DrivenAt::telescope}) {
    CAPTURE(static_cast<int>(at));
    System s({.gravity = Vec3(0, -9.81, 0)});
    s.set_planar(Plane{2});
    const auto rod = [&](const std::string& name, const Vec3& from, const Vec3& to) -> Body& {
      return s.add_body(name, shapes::rod(1.0, from, to));
    };
    Body &crank = rod("crank", {0, 0, 0}, {0, 0.4, 0}), &coupler = rod("coupler", {0, 0.4, 0}, {1, 0.8, 0}),
         &rocker = rod("rocker", {1, 0.8, 0}, {1, 0, 0});
    auto& first = s.add<Revolute>("A", crank, s.ground(), pose_at(Vec3(0, 0, 0)));
    s.add<Revolute>("B", coupler, crank, pose_at(Vec3(0, 0.4, 0)));
    s.add<Revolute>("C", rocker, coupler, pose_at(Vec3(1, 0.8, 0)));
    auto& last = s.add<Revolute>("D", rocker, s.ground(), pose_at(Vec3(1, 0, 0)));
    if (at == DrivenAt::tree) first.drive(Axis::rz, laws::polynomial({0.0, 1.0, 0.5}));
    if (at == DrivenAt::closing) last.drive(Axis::rz, laws::polynomial({0.0, 1.0, 0.5}));
    if (at == DrivenAt::telescope)
      s.add<Distance>("ram", s.add_marker_at("p", coupler, pose_at(Vec3(0.5, 0.6, 0))),
                      s.add_marker_at("s", s.ground(), pose_at(Vec3(-0.5, 0, 0))),
                      laws::polynomial({std::hypot(1.0, 0.6), 0.3}));
    Dynamics dynamics(s, std::make_unique<SchurSolver>(), {.formulation = Formulation::joint, .stabilization = {}});
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-10}});
    State start = s.start();
    assemble(dynamics, start);
    loop.set_state(start);
    const long before = dynamics.work().corrections;
    loop.run_until(0.5);
    CHECK(loop.state().coordinates != nullptr);
    CHECK(loop.report().steps > 3);
    CHECK(dynamics.work().corrections - before < loop.report().steps);
  }
}

namespace {

// Two points 0.9 m + 0.2 m/s t apart.
struct Telescope {
  static constexpr PhiSpec spec{.reads = Reads::translation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    const T length = 0.9 + 0.2 * y.t;
    return y.x * y.x + y.y * y.y + y.z * y.z - length * length;
  }
};

struct TelescopeLink final : PhiLock<Telescope> {
  TelescopeLink(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::none, Telescope{}) {}
  std::string_view type() const override { return "telescope"; }
};

}  // namespace

TEST_CASE("a function of time that closes a loop does its work in joint coordinates", "[verification][joint]") {
  const auto imbalance = [](Formulation formulation, bool by_law, double& work) {
    System s({.gravity = Vec3(0, -9.81, 0)});
    Body& left = s.add_body("left", shapes::rod(1.0, {0, 0, 0}, {0, 0.4, 0}));
    Body& right = s.add_body("right", shapes::rod(2.0, {0.9, 0.4, 0}, {0.9, 0, 0}));
    s.add<Revolute>("A", left, s.ground(), pose_at(Vec3(0, 0, 0)));
    s.add<Revolute>("B", right, s.ground(), pose_at(Vec3(0.9, 0, 0)));
    Marker &p = s.add_marker_at("p", left, pose_at(Vec3(0, 0.4, 0))),
           &q = s.add_marker_at("q", right, pose_at(Vec3(0.9, 0.4, 0)));
    if (by_law)
      s.add<Distance>("reach", p, q, laws::polynomial({0.9, 0.2}));
    else
      s.add<TelescopeLink>("reach", p, q);
    Recorder recorder(s);
    for (const char* channel : {"energy.drives", "energy.balance"}) recorder.add(make_channel(s, channel));
    Dynamics dynamics(s, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-11, 1e-11}});
    State start = s.start();
    assemble(dynamics, start);
    loop.set_state(start);
    loop.add_observer(recorder);
    loop.run_until(0.5);
    CHECK((loop.state().coordinates != nullptr) == (formulation == Formulation::joint));
    work = recorder.table().last("energy.drives");
    return std::abs(recorder.table().last("energy.balance"));
  };
  for (const bool by_law : {true, false}) {
    CAPTURE(by_law);
    double in_slots = 0, along_joints = 0;
    CHECK(imbalance(Formulation::omega, by_law, in_slots) < 1e-8);
    CHECK(imbalance(Formulation::joint, by_law, along_joints) < 1e-8);
    CHECK(std::abs(in_slots) > 0.04);
    CHECK(std::abs(along_joints - in_slots) < 1e-8);
  }
}

TEST_CASE("a look aside leaves nothing behind in joint coordinates either", "[verification][joint]") {
  const auto run = [](bool looks) {
    Scene scene = read_scene(scene_path("nfourbar_2"));
    scene.run.formulation = Formulation::joint;
    Mechanism m = build_mechanism(scene, builtin_registry());
    Dynamics dynamics = joint_dynamics(system_of(m));
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-8, 1e-8}});
    State start = m.system.start();
    assemble(dynamics, start, m.start_speeds, m.assembly);
    loop.set_state(start);
    long steps = 0;
    while (loop.state().t < 2) {
      loop.step(), ++steps;
      if (!looks) continue;
      State beside = loop.state();  // flat, where rows fade
      StateRate rate;
      for (double& q : beside.q) q = 0;
      dynamics.rates_with_report(beside, rate);
    }
    return std::pair(steps, loop.state().q);
  };
  const auto [steps, q] = run(false);
  const auto [watched_steps, watched_q] = run(true);
  CHECK(watched_steps == steps);
  CHECK(watched_q == q);
}

TEST_CASE("ten singular configurations are passed in joint coordinates as in omega", "[verification][joint]") {
  const auto run = [&](Formulation formulation) {
    return run_scene(scene_path("nfourbar_2"), [&](RunSettings& s) {
      s.integrator = {"dop853"}, s.tolerance = {1e-9, 1e-9}, s.formulation = formulation;
    });
  };
  const SceneRun omega = run(Formulation::omega), joint = run(Formulation::joint);
  for (const ColumnError& e : compare(joint.table, omega.table)) {
    CAPTURE(e.name);
    if (e.name.find("_dd") == std::string::npos) CHECK(e.error < 1e-6 * std::max(1.0, e.size));
  }
}

TEST_CASE("a step with closures allocates nothing", "[verification][joint]") {
  for (const int plane : {-1, 2}) {
    CAPTURE(plane);
    System system = row_of_four_bars(4);
    system.set_planar(Plane{plane});
    system.setup();
    Dynamics dynamics = joint_dynamics(system);
    StepLoop loop(dynamics, std::make_unique<Dopri5>());
    State start = system.start();
    start.v[5] = 0.5;
    dynamics.project_velocity(start);
    loop.set_state(start);
    // The first look at both sides of a flat position takes memory once.
    while (loop.report().manifold_steps < 20) loop.step();
    for (int i = 0; i < 200; ++i) loop.step();
    REQUIRE(loop.state().coordinates);
    const long before = allocations(), passed = loop.report().manifold_steps;
    for (int i = 0; i < 200; ++i) loop.step();
    CHECK(allocations() == before);
    CHECK(loop.report().manifold_steps > passed);
  }
}

}  // namespace closure_runs_test
