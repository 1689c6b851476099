// SPDX-License-Identifier: BSD-3-Clause
// Runs in joint coordinates against runs in omega: scenes, events, laws that jump, changes in mid-run, allocations.
#include <cmath>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/body.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/linearization.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/run_scene.h"

namespace joint_runs_test {

using namespace lockstep;
using testing::message_of;

namespace {

/// Rods of 1 m end to end, each turned out of the x axis by the angle, up and down in turn; hinges "hinge0", ... about z
/// and y in turn. Returns where the last one ends.
Vec3 add_chain(System& system, int n, double angle = 0) {
  Body* last = &system.ground();
  Vec3 at = Vec3::Zero();
  for (int i = 0; i < n; ++i, angle = -angle) {
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    const std::string name = std::to_string(i);
    Body& b = system.add_body("rod" + name, {1.0, Vec3::Zero(), Vec3(0.01, 1.0 / 12, 1.0 / 12).asDiagonal()},
                              {at + 0.5 * along, axis_angle(Vec3::UnitZ(), angle)});
    system.add<Revolute>("hinge" + name, b, *last, pose_at(at, i % 2 ? Vec3::UnitY() : Vec3::UnitZ()));
    last = &b, at += along;
  }
  return at;
}

Dynamics dynamics_of(System& system, Formulation formulation) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
}

/// The state of a loop in the slots' own coordinates; the run was in joint coordinates unless it was to be in omega.
State end_of(StepLoop& loop, Dynamics& dynamics) {
  CHECK((loop.state().coordinates == nullptr) == (dynamics.options().formulation == Formulation::omega));
  State end = loop.state();
  dynamics.to_slots(end);
  return end;
}

void check_alike(const State& joint, const State& omega) {
  CHECK((joint.v - omega.v).lpNorm<Eigen::Infinity>() < 1e-9 * omega.v.lpNorm<Eigen::Infinity>());
  for (int k = 0; k < omega.q.size() / 7; ++k) CHECK((joint.slot_pose(k).x - omega.slot_pose(k).x).norm() < 1e-9);
}

constexpr Tolerance kTight{1e-12, 1e-14};

}  // namespace

TEST_CASE("scenes move in joint coordinates as in omega", "[verification][joint]") {
  const std::string scene = GENERATE("chain_10", "double_pendulum", "heavy_top", "pendulum",  // trees
                                     "andrews_ivp", "four_bar", "nfourbar_40", "slider_crank", "stewart");
  const std::string method = GENERATE("dopri5", "dop853");
  CAPTURE(scene, method);
  const auto run = [&](Formulation formulation) {
    return run_scene(scene_path(scene), [&](RunSettings& s) {
      s.integrator = {method};
      s.tolerance = {1e-12, 1e-14};
      s.until = scene == "andrews_ivp" ? 0.01 : 0.2, s.times.clear(), s.output = 0.1 * s.until;
      s.formulation = formulation;
    });
  };
  const SceneRun omega = run(Formulation::omega), joint = run(Formulation::joint);
  REQUIRE(omega.table.columns().size() > 1);
  for (const ColumnError& e : compare(joint.table, omega.table)) {
    CAPTURE(e.name);
    CHECK(e.error < 1e-9 * std::max(1.0, e.size));
  }
}

TEST_CASE("events change states and joints in joint coordinates as in omega", "[verification][joint]") {
  const auto run = [](Formulation formulation, const std::string& what) {
    System system({.gravity = {0, -9.81, 0}});
    const Vec3 end = add_chain(system, 3, 0.4);  // bent: a straight chain that is held at both ends is singular
    system.add<Spherical>("catch", system.body("rod2"), system.ground(), pose_at(end));
    system.link("catch").set_active_at_start(what == "released");
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = kTight});
    Event event{.name = what, .at = 0.1};
    if (what == "released") event.deactivate = {"catch"};
    if (what == "cut") event.deactivate = {"hinge1"};
    if (what == "kicked")
      event.change = [&](State& s) { StateEditor(s).set_twist(system.body("rod2"), {{0, 1, 0}, {0, 0, 9}}); };
    loop.add_event(event);
    loop.run_until(0.3);
    return end_of(loop, dynamics);
  };
  const std::string what = GENERATE("released", "cut", "kicked");
  CAPTURE(what);
  const State omega = run(Formulation::omega, what), joint = run(Formulation::automatic, what);
  check_alike(joint, omega);
}

TEST_CASE("revolutions are counted on over events, a saved state continues elsewhere", "[verification][joint]") {
  const auto make = [](System& system) {
    Body& wheel = system.add_body("wheel", MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()});
    wheel.start.w = {0, 0, 20};
    system.add<Revolute>("axle", wheel, system.ground(), pose_at(Vec3(0, 0, 0), Vec3(0, 0, 1)));
  };
  System one, two;
  make(one), make(two);
  Dynamics a = dynamics_of(one, Formulation::joint), b = dynamics_of(two, Formulation::joint);
  StepLoop first(a, std::make_unique<Dopri5>()), second(b, std::make_unique<Dopri5>());
  first.add_event({.name = "nothing", .at = 1.0, .change = [](State&) {}});
  first.run_until(2.0);
  REQUIRE(first.state().coordinates);
  CHECK(first.state().q[0] == Approx(40.0).epsilon(1e-12));  // six turns and more
  second.set_state(first.state());
  second.run_until(3.0);
  const Vec3 w = second.state().slot_twist(0).w;
  CHECK((w - Vec3(0, 0, 20)).norm() < 1e-12);
  const Mat3 A = rotation(second.state().slot_pose(0).q);
  CHECK(std::abs(A(0, 0) - std::cos(60.0)) + std::abs(A(1, 0) - std::sin(60.0)) < 1e-10);
}

TEST_CASE("mechanisms without joint coordinates are rejected in them by name, and run in omega by auto",
          "[verification][joint]") {
  const auto run = [&](const std::string& scene, Formulation formulation) {
    return run_scene(scene_path(scene), [&](RunSettings& s) { s.until = 0.05, s.formulation = formulation; });
  };
  const std::string words = message_of<ModelError>([&] { run("sliding_block", Formulation::joint); });
  CHECK(words.find("force 'guide.friction' reads reactions") != std::string::npos);
  CHECK(run("sliding_block", Formulation::automatic).table.n_rows() > 0);

  const auto by = [&](const std::string& method, Formulation formulation) {
    return run_scene(scene_path("chain_10"), [&](RunSettings& s) {
      s.integrator = {method}, s.step = 1e-3, s.tolerance = {};
      s.until = 0.005, s.times.clear(), s.output = 0.001, s.formulation = formulation;
    });
  };
  for (const char* method : {"radau5", "rattle2"}) {  // state their formulation
    CAPTURE(method);
    const std::string refused = message_of<ModelError>([&] { by(method, Formulation::joint); });
    CHECK(refused.find("joint coordinates (formulation joint) are not possible") != std::string::npos);
    CHECK(refused.find(method) != std::string::npos);
    const Table omega = by(method, Formulation::omega).table, automatic = by(method, Formulation::automatic).table;
    for (const ColumnError& e : compare(automatic, omega)) CHECK(e.error == 0);
  }
}

TEST_CASE("stops, impacts and rest on a stop are those of omega along joints", "[verification][joint]") {
  const auto bouncing = [&](Formulation formulation) {
    return run_scene(scene_path("bouncing_pendulum"), [&](RunSettings& s) { s.formulation = formulation; });
  };
  const SceneRun joint = bouncing(Formulation::joint), omega = bouncing(Formulation::omega);
  CHECK(joint.report.impacts == omega.report.impacts);
  CHECK(joint.report.impacts > 3);
  for (const ColumnError& e : compare(joint.table, omega.table)) {
    CAPTURE(e.name);
    CHECK(e.error <= 1e-7 * std::max(1.0, e.size));
  }

  // A chain of two that falls on a rope, stretches it, and hangs on it; in the middle of the fall a hinge is driven.
  const auto falling = [](Formulation formulation) {
    System system({.gravity = Vec3(0, -9.81, 0)});
    const Vec3 end = add_chain(system, 2, 0.4);
    Marker &p = system.add_marker("p", system.body("rod1"), {Vec3(0.5, 0, 0), Quat{}}),
           &s = system.add_marker("s", system.ground(), {Vec3(end + Vec3(0.2, 0.1, 0.1)), Quat{}});
    Distance& rope = system.add<Distance>("rope", p, s, 0.5);
    rope.set_unilateral({0.3, 1e-3, true});
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = kTight});
    loop.run_until(3.0);
    CHECK(loop.report().impacts >= 2);
    CHECK(dynamics.violation(loop.state()) < 1e-9);
    return end_of(loop, dynamics);
  };
  check_alike(falling(Formulation::joint), falling(Formulation::omega));
}

TEST_CASE("a pendulum on a cart whose speed jumps moves in joint coordinates as in omega", "[verification][joint]") {
  const auto run = [](Formulation formulation) {
    System system({.gravity = {0, -9.81, 0}});
    Body& cart = system.add_body("cart", shapes::box(2, {0.2, 0.1, 0.1}));
    Body& rod = system.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {0.3, -0.6, 0}));
    auto& slide = system.add<Prismatic>("slide", cart, system.ground(), pose_at(Vec3(0, 0, 0), Vec3::UnitX()));
    slide.drive_speed(Axis::z,
                      laws::sequence({{0.1, laws::constant(1.0)}, {0.2, laws::constant(-2.0)}, {9, laws::ramp(1.0)}}));
    system.add<Revolute>("hinge", rod, cart, pose_at(Vec3(0, 0, 0), Vec3(0.1, 0, 1)));
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = kTight});
    State start = system.start();
    assemble(dynamics, start);
    loop.set_state(start);
    loop.run_until(0.5);
    CHECK(dynamics.violation(loop.state()) < 1e-12);
    return end_of(loop, dynamics);
  };
  const State omega = run(Formulation::omega), joint = run(Formulation::joint);
  check_alike(joint, omega);
  CHECK(std::abs(joint.s[0] - omega.s[0]) < 1e-12);
}

TEST_CASE("a mass changed in mid-run counts from there on", "[verification][joint]") {
  const auto run = [](Formulation formulation) {
    System system({.gravity = {0, -9.81, 0}});
    add_chain(system, 3);
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = kTight});
    loop.run_until(0.1);
    system.body("rod1").mass.mass = 5, system.body("rod1").mass.J *= 5;
    system.changed();
    loop.run_until(0.3);
    return end_of(loop, dynamics);
  };
  const State omega = run(Formulation::omega), joint = run(Formulation::joint);
  check_alike(joint, omega);
}

TEST_CASE("gains of a stabilisation have no effect in joint coordinates, and a run reports it",
          "[verification][joint]") {
  const auto warnings = [](Formulation formulation, Stabilization::Kind kind) {
    System system({.gravity = {0, -9.81, 0}});
    add_chain(system, 3);
    Dynamics dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {kind}});
    StepLoop loop(dynamics, std::make_unique<Dopri5>());
    return texts_of(loop.run_until(0.01).findings);
  };
  using Kind = Stabilization::Kind;
  for (const Kind kind : {Kind::baumgarte, Kind::none}) {
    const std::vector<std::string> said = warnings(Formulation::joint, kind);
    REQUIRE(said.size() == 1);
    CHECK(said[0].find("stabilisation has no effect") != std::string::npos);
    CHECK(said[0].find("formulation omega") != std::string::npos);
    CHECK(warnings(Formulation::omega, kind).empty());
  }
  CHECK(warnings(Formulation::joint, Kind::project).empty());
}

namespace {

/// A wheel of 2 kg m^2 about its axle, which a host turns by a torque.
struct DrivenWheel {
  System system;
  std::shared_ptr<InputLaw> torque = std::make_shared<InputLaw>();
  DrivenWheel() {
    Body& wheel = system.add_body("wheel", MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()});
    system.add<Revolute>("axle", wheel, system.ground(), pose_at(Vec3(0, 0, 0), Vec3(0, 0, 1)));
    system.add<TorqueMotor>("motor", system.add_marker("shaft", wheel), system.add_marker("frame", system.ground()),
                            TorqueMotor::Options{torque});
  }
};

}  // namespace

// A host may change what acts between two steps: no rate of the last step serves as the first of the next.
TEST_CASE("a torque that a host changes between runs acts from their first stage on", "[verification][joint]") {
  const double u = 3, h = 0.5;
  DrivenWheel wheel;
  Dynamics dynamics = dynamics_of(wheel.system, Formulation::automatic);
  StepLoop loop(dynamics, std::make_unique<Dopri5>(true), {.step = h});
  loop.run_until(2 * h);
  REQUIRE(loop.state().coordinates);
  CHECK(loop.state().slot_twist(0).w.z() == 0);
  wheel.torque->add({u, 0, 0});
  loop.run_until(3 * h);
  CHECK(loop.state().slot_twist(0).w.z() == Approx(u / 2 * h).epsilon(1e-14));
  CHECK(loop.state().q[0] == Approx(0.5 * u / 2 * h * h).epsilon(1e-14));
}

// Methods that keep accelerations from step to step begin anew where they would be those of before.
TEST_CASE("changes by a host between two calls act from then on, in every method", "[verification][joint]") {
  const auto name = GENERATE(as<std::string>{}, "dopri5", "dop853", "rk4", "radau5", "rattle2", "rattle4",
                             "generalized_alpha", "semi_implicit_euler");
  const bool by_steps = GENERATE(false, true);
  CAPTURE(name, by_steps);
  const double u = 3, h = 0.125;
  DrivenWheel wheel;
  Dynamics dynamics = dynamics_of(wheel.system, Formulation::automatic);
  StepLoop loop(dynamics, builtin_registry().integrators.make(name, Params{}, nullptr, "run.integrator"), {.step = h});
  const auto go_on = [&](double t) {
    if (!by_steps) loop.run_until(t);
    while (loop.state().t < t - 1e-12) loop.step(t - loop.state().t);
  };
  go_on(1);
  wheel.torque->add({u, 0, 0});
  go_on(2);
  CHECK(loop.state().slot_twist(0).w.z() == Approx(u / 2).epsilon(1e-9));
  wheel.torque->add({-2 * u, 0, 0});
  go_on(4);
  CHECK(loop.state().slot_twist(0).w.z() == Approx(u / 2 - 2 * u).epsilon(1e-9));
}

TEST_CASE("a step in joint coordinates allocates nothing", "[verification][joint]") {
  for (const bool driven : {false, true}) {  // driven: the work of the drive takes the joint's reactions
    CAPTURE(driven);
    System system({.gravity = {0, -9.81, 0}});
    add_chain(system, 10);
    Recorder recorder(system);
    if (driven) {
      system.link("hinge4").jointed()->drive(Axis::rz, laws::polynomial({0.0, 0.0, 2.0}));
      recorder.add(make_channel(system, "hinge4.drive.work"));
    }
    Dynamics dynamics = dynamics_of(system, Formulation::joint);
    StepLoop loop(dynamics, std::make_unique<Dopri5>());
    for (int i = 0; i < 20; ++i) loop.step();
    REQUIRE(loop.state().coordinates);
    CHECK(loop.state().s.size() == (driven ? 1 : 0));
    const long before = allocations();
    for (int i = 0; i < 20; ++i) loop.step();
    CHECK(allocations() == before);
    if (driven) CHECK(std::abs(loop.state().s[0]) > 1e-3);
  }
}

}  // namespace joint_runs_test
