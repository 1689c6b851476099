// SPDX-License-Identifier: BSD-3-Clause
// Mechanisms that laws alone move: in joint coordinates nothing is unknown, and they are evaluated. Against closed forms,
// conservation, and runs in omega.
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/passes.h>
#include <lockstep/body.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/random_bodies.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace trees_along_laws_test {

using namespace lockstep;
using testing::check_words, testing::largest, testing::message_of;

namespace {

constexpr Tolerance kTight{1e-12, 1e-14};

struct Swing {
  double amplitude, omega, phase;
  double at(double t) const { return amplitude * std::sin(omega * t + phase); }
};
constexpr std::array<Swing, 3> kSwings{{{0.8, 1.5, 0}, {0.5, 2.0, 0.4}, {0.6, 3.5, 1}}};

/// Three rods end to end on hinges "hinge0" ... , about z and y in turn, or all about z; each is driven by its swing.
System arm(bool flat = false) {
  System system({.gravity = {0, -9.81, 0}});
  Body* last = &system.ground();
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::to_string(i);
    Body& rod = system.add_body("rod" + name, {1.0 + i, Vec3::Zero(), Vec3(0.01, 1.0 / 12, 1.0 / 12).asDiagonal()},
                                {Vec3(i + 0.5, 0, 0), {}});
    auto& hinge = system.add<Revolute>("hinge" + name, rod, *last,
                                       pose_at(Vec3(i, 0, 0), !flat && i % 2 ? Vec3::UnitY() : Vec3::UnitZ()));
    const auto [amplitude, omega, phase] = kSwings[i];
    hinge.drive(Axis::rz, laws::sine({.amplitude = amplitude, .omega = omega, .phase = phase}));
    last = &rod;
  }
  return system;
}

Dynamics dynamics_of(System& system, Formulation formulation = Formulation::automatic) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
}

State start_of(Dynamics& dynamics) {
  State start = dynamics.system().start();
  assemble(dynamics, start);
  return start;
}

bool is_evaluated(const State& y) { return y.coordinates && y.q.size() == 0 && y.v.size() == 0; }

template <class Method>
Table recorded(System& system, std::vector<Request> wanted, Tolerance tolerance, double end,
               Formulation formulation = Formulation::automatic) {
  Recorder recorder(system, std::move(wanted));
  Dynamics dynamics = dynamics_of(system, formulation);
  StepLoop loop(dynamics, std::make_unique<Method>(), {.tolerance = tolerance, .output = 0.01});
  loop.set_state(start_of(dynamics));
  loop.add_observer(recorder);
  loop.run_until(end);
  CHECK((loop.state().coordinates != nullptr) == (formulation != Formulation::omega));
  return recorder.table();
}

/// A method that chooses its steps by a way of its own: it would see no error where laws alone move.
class OfOthers final : public Integrator {
 public:
  IntegratorInfo info() const override {
    IntegratorInfo info = inner_.info();
    info.name = "of_others";
    return info;
  }
  void begin(Dynamics& dynamics, const State& y) override { inner_.begin(dynamics, y); }
  StepReport step(Dynamics& dynamics, State& y, double h) override { return inner_.step(dynamics, y, h); }
  void set_tolerance(const Tolerance& tolerance) override { inner_.set_tolerance(tolerance); }
  double first_step(Dynamics& dynamics, const State& y, double most) override {
    return inner_.first_step(dynamics, y, most);
  }

 private:
  Dopri5 inner_;
};

}  // namespace

TEST_CASE("a mechanism that laws alone move has no unknowns: exact at any tolerance, between steps too",
          "[verification][joint]") {
  for (const bool flat : {false, true})
    for (const bool by_name : {false, true}) {
      CAPTURE(flat, by_name);
      System system = arm(flat);
      if (by_name && flat) system.set_planar(Plane{2});
      Recorder recorder(system, {"hinge0.rz", "hinge1.rz", "hinge2.rz"});
      Dynamics dynamics = dynamics_of(system, by_name ? Formulation::joint : Formulation::automatic);
      StepLoop loop(dynamics, std::make_unique<Dopri5>(), {.tolerance = {1e-3, 1e-5}, .output = 0.01});
      loop.set_state(start_of(dynamics));
      loop.add_observer(recorder);
      loop.run_until(2.0);
      CHECK(is_evaluated(loop.state()));
      CHECK(loop.report().steps < 100);  // fewer than the outputs
      CHECK(dynamics.violation(loop.state()) < 1e-14);
      const Table& t = recorder.table();
      REQUIRE(t.n_rows() == 201);
      double worst = 0;
      for (std::size_t i = 0; i < t.n_rows(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
          keep_worst(worst, std::abs(t["hinge" + std::to_string(k) + ".rz"][i] - kSwings[k].at(t["t"][i])));
      CHECK(worst < 1e-14);
    }
}

TEST_CASE("rates of bodies that laws alone move are the accelerations of omega", "[verification][joint]") {
  for (const bool flat : {false, true}) {
    System system = arm(flat);
    Dynamics dynamics = dynamics_of(system, Formulation::joint);
    State y = start_of(dynamics);
    dynamics.to_formulation(y);
    REQUIRE(is_evaluated(y));
    CHECK((static_cast<const JointTree&>(*y.coordinates).planar() != nullptr) == flat);
    for (const double t : {0.0, 0.3, 1.7}) {
      y.t = t;
      StateRate rate = sized_like(y);
      dynamics.rates(y, rate);
      const VecX expected = testing::accelerations(dynamics, y);
      CHECK(rate.q.size() == 0);
      CHECK(rate.v.size() == 0);
      REQUIRE(y.coordinates->followed().size() == static_cast<std::size_t>(system.n_slots()));
      REQUIRE(rate.followed.size() == 2 * expected.size());
      std::vector<Motion> motions;
      passes::motions(system, y, motions);
      Eigen::Index at = 0;
      for (const int k : y.coordinates->followed()) {
        const Motion& O = motions[k + 1];
        CHECK((rate.followed.segment<3>(at) - O.v).norm() < 1e-14);
        CHECK((rate.followed.segment<3>(at + 3) - O.A * O.w).norm() < 1e-14);
        CHECK((rate.followed.segment<6>(at + 6) - expected.segment<6>(6 * k)).norm() < 1e-12 * largest(expected));
        at += 12;
      }
      CHECK(rate.largest_a > 0);
    }
  }
}

TEST_CASE("steps along laws are hardly shorter than those of omega, and not twice as long", "[verification][joint]") {
  const auto steps = [](auto method, double tolerance, Formulation formulation) {
    System system = arm();
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::move(method), {.tolerance = {tolerance, 1e-2 * tolerance}});
    loop.set_state(start_of(dynamics));
    loop.run_until(4.0);
    return static_cast<double>(loop.report().steps + loop.report().rejected);
  };
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    const double d5 = steps(std::make_unique<Dopri5>(), tolerance, Formulation::joint) /
                      steps(std::make_unique<Dopri5>(), tolerance, Formulation::omega),
                 d8 = steps(std::make_unique<Dop853>(), tolerance, Formulation::joint) /
                      steps(std::make_unique<Dop853>(), tolerance, Formulation::omega);
    CAPTURE(tolerance, d5, d8);
    for (const double of_omega : {d5, d8}) {
      CHECK(of_omega < 1.1);
      CHECK(of_omega > 0.5);
    }
  }
}

TEST_CASE("the work of drives on a mechanism that they alone move is its energy", "[verification][joint]") {
  System system = arm();
  const Table t = recorded<Dop853>(
      system, {"energy.kinetic", "energy.potential", "hinge0.drive.work", "hinge1.drive.work", "hinge2.drive.work"},
      {1e-11, 1e-13}, 2.0);
  const auto energy = [&](std::size_t i) { return t["energy.kinetic"][i] + t["energy.potential"][i]; };
  double worst = 0, most = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double work = t["hinge0.drive.work"][i] + t["hinge1.drive.work"][i] + t["hinge2.drive.work"][i];
    keep_worst(worst, std::abs(energy(i) - energy(0) - work)), keep_worst(most, std::abs(work));
  }
  CHECK(most > 10);
  CHECK(worst < 1e-9 * most);
}

TEST_CASE("the robot arm runs along its joints: positions, torques and works as in omega", "[verification][joint]") {
  const auto run = [](Formulation formulation) {
    return run_scene(scene_path("robot_arm"), [&](RunSettings& s) {
      s.formulation = formulation, s.tolerance = {1e-12, 1e-14};
      for (const char* works : {"J1", "J3", "J6"})
        s.record.push_back({std::string(works) + ".drive.work", std::string("work of ") + works, {}});
    });
  };
  const SceneRun joint = run(Formulation::automatic), omega = run(Formulation::omega);
  CHECK(joint.work.factors < omega.work.factors / 5);  // for the reactions that are recorded alone
  for (const ColumnError& e : compare(joint.table, omega.table)) {
    CAPTURE(e.name);
    CHECK(e.error < 1e-9 * std::max(1.0, e.size));
  }
}

TEST_CASE("an event lets a driven hinge go, and another takes it again", "[verification][joint]") {
  const auto run = [](Formulation formulation) {
    System system = arm();
    for (const char* name : {"loose", "taken"}) {
      auto& hinge = system.add<Revolute>(name, system.body("rod2"), system.body("rod1"), pose_at(Vec3(2, 0, 0)));
      if (name[0] == 't') hinge.drive_speed(Axis::rz, laws::sine({.amplitude = 2, .omega = 3}));
      hinge.set_active_at_start(false);
    }
    Dynamics dynamics = dynamics_of(system, formulation);
    StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = kTight});
    loop.set_state(start_of(dynamics));
    loop.add_event({.name = "go", .at = 0.4, .activate = {"loose"}, .deactivate = {"hinge2"}});
    loop.add_event({.name = "take", .at = 0.6, .activate = {"taken"}, .deactivate = {"loose"}});
    const bool joint = formulation != Formulation::omega;
    loop.run_until(0.3);
    CHECK(is_evaluated(loop.state()) == joint);
    loop.run_until(0.5);
    CHECK((loop.state().coordinates && loop.state().v.size() == 1) == joint);
    loop.run_until(0.8);
    CHECK(is_evaluated(loop.state()) == joint);
    State end = loop.state();
    dynamics.to_slots(end);
    return end;
  };
  const State joint = run(Formulation::automatic), omega = run(Formulation::omega);
  CHECK(largest(joint.v - omega.v) < 1e-9 * largest(omega.v));
  CHECK(largest(joint.q - omega.q) < 1e-9);
}

TEST_CASE("a condition on a motion by laws is met at the time of its closed form", "[verification][joint]") {
  System system = arm();
  Dynamics dynamics = dynamics_of(system);
  StepLoop loop(dynamics, std::make_unique<Dopri5>(), {.tolerance = {1e-3, 1e-5}});
  loop.set_state(start_of(dynamics));
  const auto angle = [](const Sample& s) {
    return 2 * std::atan2(s.inputs().slot(0).e.vec().z(), s.inputs().slot(0).e.w);
  };
  loop.add_event({.name = "there", .value = [&](const Sample& s) { return angle(s) - 0.4; }, .stop = true});
  loop.run_until(2.0);
  CHECK(is_evaluated(loop.state()));
  CHECK(loop.state().t == Approx(std::asin(0.4 / kSwings[0].amplitude) / kSwings[0].omega).epsilon(1e-9));
}

TEST_CASE("a speed that a law gives is the one state of a mechanism that it alone moves, over jumps too",
          "[verification][joint]") {
  System system({.gravity = {0, -9.81, 0}});
  Body& cart = system.add_body("cart", shapes::box(2, {0.2, 0.1, 0.1}));
  system.add<Prismatic>("slide", cart, system.ground(), pose_at(Vec3(0, 0, 0), Vec3::UnitX()))
      .drive_speed(Axis::z,
                   laws::sequence({{0.1, laws::constant(1.0)}, {0.2, laws::constant(-2.0)}, {9, laws::ramp(1.0)}}));
  Dynamics dynamics = dynamics_of(system);
  StepLoop loop(dynamics, std::make_unique<Dopri5>(), {.tolerance = {1e-6, 1e-9}});
  loop.set_state(start_of(dynamics));
  loop.run_until(0.5);
  CHECK(is_evaluated(loop.state()));
  REQUIRE(loop.state().s.size() == 1);
  const double x = loop.state().slot_pose(0).x.x(), v = loop.state().slot_twist(0).v.x();
  CHECK(x == Approx(loop.state().s[0]).epsilon(1e-14));
  Dynamics omega = dynamics_of(system, Formulation::omega);
  StepLoop other(omega, std::make_unique<Dopri5>(), {.tolerance = {1e-6, 1e-9}});
  other.set_state(start_of(omega));
  other.run_until(0.5);
  CHECK(std::abs(x - other.state().slot_pose(0).x.x()) < 1e-9);
  CHECK(std::abs(v - other.state().slot_twist(0).v.x()) < 1e-9);
}

TEST_CASE("a saved run along laws continues to the last bit", "[verification][joint]") {
  const auto make = [](System& system) {
    system = arm();
    Body& wheel = system.add_body("wheel", MassProperties{1.0, Vec3::Zero(), Vec3(1, 1, 2).asDiagonal()},
                                  Pose{Vec3(3, 0, 0), {}});
    system.add<Revolute>("axle", wheel, system.body("rod2"), pose_at(Vec3(3, 0, 0)))
        .drive_speed(Axis::rz, laws::sine({.amplitude = 2, .omega = 3}));
  };
  const auto method = GENERATE(0, 1);
  const auto integrator = [&]() -> std::unique_ptr<Integrator> {
    if (method == 0) return std::make_unique<Dopri5>();
    return std::make_unique<Dop853>();
  };
  System one, two;
  make(one), make(two);
  Dynamics a = dynamics_of(one), b = dynamics_of(two);
  const StepLoopOptions options{.tolerance = {1e-7, 1e-9}};
  StepLoop first(a, integrator(), options), second(b, integrator(), options);
  first.set_state(start_of(a));
  for (int i = 0; i < 7; ++i) first.step();
  Snapshot saved;
  first.save(saved);
  second.load(saved);
  CHECK(is_evaluated(second.state()));
  for (int i = 0; i < 20; ++i) first.step(), second.step();
  CHECK(first.state().t == second.state().t);
  CHECK(first.state().s == second.state().s);
  CHECK(first.state().slot_pose(3).x == second.state().slot_pose(3).x);
  const double t = first.state().t;
  CHECK(first.state().s[0] == Approx(2.0 / 3 * (1 - std::cos(3 * t))).epsilon(1e-6));
}

TEST_CASE("fixed steps along laws simply step, and allocate nothing", "[verification][joint]") {
  System system = arm();
  Dynamics dynamics = dynamics_of(system);
  StepLoop loop(dynamics, std::make_unique<Rk4>(), {.step = 0.1});
  loop.set_state(start_of(dynamics));
  loop.run_until(1.0);
  CHECK(is_evaluated(loop.state()));
  CHECK(loop.report().steps == 10);
  const double half = 0.5 * kSwings[0].at(1.0);
  CHECK(std::abs(loop.state().slot_pose(0).x.y() - 0.5 * std::sin(2 * half)) < 1e-15);

  StepLoop chosen(dynamics, std::make_unique<Dopri5>());
  chosen.set_state(start_of(dynamics));
  for (int i = 0; i < 20; ++i) chosen.step();
  const long before = allocations();
  for (int i = 0; i < 20; ++i) chosen.step();
  CHECK(allocations() == before);
}

TEST_CASE("a method that does not support mechanisms moved by laws alone runs them in omega", "[verification][joint]") {
  System system = arm();
  Dynamics dynamics = dynamics_of(system), by_name = dynamics_of(system, Formulation::joint);
  StepLoop loop(dynamics, std::make_unique<OfOthers>(), {.tolerance = {1e-6, 1e-8}}),
      refused(by_name, std::make_unique<OfOthers>());
  loop.set_state(start_of(dynamics)), refused.set_state(start_of(by_name));
  loop.run_until(0.2);
  CHECK(loop.state().coordinates == nullptr);
  CHECK(loop.report().steps > 3);
  check_words(message_of<ModelError>([&] { refused.run_until(0.2); }), {"of_others", "moved by laws alone"});

  // A door that both of its hinges drive: nothing is free, and one of them closes a loop.
  System door({.gravity = Vec3(0, 0, -9.81)});
  Body& leaf = door.add_body("leaf", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  for (const char* name : {"low", "high"})
    door.add<Revolute>(name, leaf, door.ground(), pose_at(Vec3(0, 0, name[0] == 'h')))
        .drive(Axis::rz, laws::sine({.amplitude = 0.5, .omega = 2}));
  Dynamics doubled = dynamics_of(door);
  check_words(doubled.why_not_joint(door.start().modes), {"no coordinate is free, but joint '", "' has constraints"});
}

namespace {

/// A push that fails from 0.3 s on.
class Broken final : public Force {
 public:
  explicit Broken(bool throws) : Force("broken"), throws_(throws) {}
  std::string_view type() const override { return "broken"; }
  std::vector<const Marker*> markers() const override { return {}; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override {
    if (in.t < 0.3) return;
    if (throws_) throw 42;
    out.torque(1, Vec3(0, std::nan(""), 0));
  }

 private:
  bool throws_;
};

}  // namespace

TEST_CASE("a force that fails is reported by name although laws alone move everything", "[verification][joint]") {
  const bool throws = GENERATE(false, true);
  System system = arm();
  system.add(std::make_unique<Broken>(throws));
  Dynamics dynamics = dynamics_of(system);
  StepLoop loop(dynamics, std::make_unique<Dopri5>());
  loop.set_state(start_of(dynamics));
  const auto run = [&] { loop.run_until(1.0); };
  if (throws)
    check_words(message_of<UserCodeError>(run), {"'broken'"});
  else
    check_words(message_of<Error>(run), {"'broken'", "not finite"});
  CHECK(is_evaluated(loop.state()));
  CHECK(loop.state().t <= 0.3);
}

}  // namespace trees_along_laws_test
