// SPDX-License-Identifier: BSD-3-Clause
// What slips that were planted in dynamics, integrators and forces once got past: each test fails with one of
// tests/mutants/*.patch.
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/author/stepping.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/frame_laws.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/recorder.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include <lockstep/system.h>
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/tools/record/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/motions.h"

namespace planted_motion_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of, lockstep::testing::says;

namespace {

std::unique_ptr<Integrator> method_of(const std::string& name) {
  return builtin_registry().integrators.make(name, Params{}, nullptr, "run.integrator");
}

/// The lengths of the steps of a run, added up.
class Lengths final : public Observer {
 public:
  double sum = 0;
  void step(const Sample& s) override { sum += s.report.h; }
};

/// Says that it stays in every plane, and pushes along z farther out than 1 km.
class Leaving final : public Force {
 public:
  explicit Leaving(const Marker& at) : Force("leaving"), at_(at) {}
  std::string_view type() const override { return "leaving"; }
  std::vector<const Marker*> markers() const override { return {&at_}; }
  bool stays_in_plane(Plane) const override { return true; }
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override {
    const Vec3& x = in.slot(at_.body->slot).x;
    out.force(at_.body->slot, Vec3(1, 0, x[0] < 1000 ? 0 : 1), x);
  }

 private:
  const Marker& at_;
};

/// Two uprights and a bar of 1 m, all flat along x, turning about z at 1.5 rad/s.
struct FlatParallelogram {
  System system{System::Options{{0, -9.81, 0}}};
  Body* left;

  FlatParallelogram() {
    const double w = 1.5;
    const Vec3 x = Vec3::UnitX(), z = Vec3::UnitZ();
    std::vector<Body*> uprights;
    for (const double at : {0.0, 1.0}) {
      Body& b = system.add_body(at == 0 ? "left" : "right", shapes::slender_rod(1, at * x, (at + 1) * x, 0.01));
      b.start = {cross(Vec3(w * z), Vec3(0.5 * x)), w * z};
      system.add<Revolute>(at == 0 ? "A" : "D", b, system.ground(), pose_at(at * x, z));
      uprights.push_back(&b);
    }
    left = uprights[0];
    Body& bar = system.add_body("bar", shapes::slender_rod(1, x, 2 * x, 0.01));
    bar.start = {cross(Vec3(w * z), x), Vec3::Zero()};
    system.add<Revolute>("B", bar, *uprights[0], pose_at(x, z));
    system.add<Revolute>("C", bar, *uprights[1], pose_at(2 * x, z));
  }
};

}  // namespace

TEST_CASE("integrated states between two steps follow their cubic", "[mutants]") {
  const auto at = [](double t) {
    State y;
    y.t = t;
    y.q.setZero(7), y.v.setZero(6);
    y.q[3] = 1;
    y.s = Eigen::Vector2d(t * t * t - 2 * t, 3 * t * t);
    return y;
  };
  const auto rate = [](double t) { return VecX(Eigen::Vector2d(3 * t * t - 2, 6 * t)); };
  QuinticOutput output;
  output.begin(at(0.5));
  output.set(at(0.5), VecX::Zero(6), rate(0.5), at(0.8), VecX::Zero(6), rate(0.8));
  for (const double t : {0.5, 0.57, 0.65, 0.77, 0.8}) {
    State inside;
    REQUIRE(output.at(t, inside));
    CHECK((inside.s - at(t).s).norm() < 1e-14);
  }
}

TEST_CASE("a NaN in the error of an integrated state is an error without limit", "[mutants]") {
  ThrownTop top;
  State y = top.system.start();
  y.s.setZero(2);
  StateRate rate = sized_like(y), error = sized_like(y);
  for (const int controlled : {0, 1, 2}) {
    ErrorNorm norm;
    norm.set({1e-6, 1e-8});
    norm.set_states(controlled);
    norm.scale(y, rate, 0.1, y);
    error.s.setZero();
    CHECK(norm.of(error, y) == 0);
    for (int i = 0; i < 2; ++i) {
      error.s.setZero(), error.s[i] = std::numeric_limits<double>::quiet_NaN();
      CHECK(norm.of(error, y) == HUGE_VAL);
    }
  }
}

TEST_CASE("rates of integrated states in a singular configuration come from both sides of it", "[mutants]") {
  FlatParallelogram flat;
  const int slot_of_left = [&] {
    flat.system.setup();
    return flat.left->slot;
  }();
  // The middle of an upright is at x = cos(theta)/2.
  const Quadrature& sum =
      quadrature(flat.system, "x of left", [slot_of_left](const Evaluated& v) { return v.in.slot(slot_of_left).x[0]; });
  Dynamics dynamics(flat.system, std::make_unique<SchurSolver>());
  dynamics.set_up();
  State s = flat.system.start();
  SingularRate through;
  through.begin(s);
  StateRate k = sized_like(s);
  REQUIRE(through.find(dynamics, s, 0, k) == SingularRate::Sides::agree);
  CHECK(k.s[sum.first()] == Approx(0.5).epsilon(1e-9));
}

TEST_CASE("works in rattle are of the order of the method", "[mutants]") {
  // A particle that falls: the work of a force of 3 t^4 N along its way.
  for (const int order : {2, 4}) {
    double error[2];
    for (int i = 0; i < 2; ++i) {
      Stone stone;
      stone.system.setup();
      const Quadrature& work = quadrature(
          stone.system, "work", [](const Evaluated& v) { return 3 * v.in.slot(0).v[2] * std::pow(v.in.t, 4); });
      Dynamics dynamics = dynamics_of(stone.system);
      dynamics.set_up();
      Rattle method(order);
      const State s = stepped(dynamics, method, 1.0, 20 << i);
      error[i] = std::abs(work.value(s) + 5.0);  // -30 t^5 from 0 to 1
    }
    CHECK(error[0] < 0.1);
    CHECK(std::log2(error[0] / error[1]) > order - 0.2);
  }
}

TEST_CASE("the adaptive generalized_alpha keeps velocities of fast bodies to the tolerance too", "[mutants]") {
  // 1 km/s along x, so that no step changes the position by much of itself, and a push of sin(20 t).
  System system;
  Body& body = system.add_body("body", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  body.start.v = {1000, 0, 0};
  Marker& at = system.add_marker("at", body);
  system.add(std::make_unique<AppliedForce>(
      "push", at,
      AppliedForce::Options{.law = laws::law([](auto t) { return sin(20.0 * t); }), .direction = {1, 0, 0}}));
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<GeneralizedAlpha>(0.8, true), {.tolerance = {1e-4, 1e-6}});
  run.run_until(1);
  CHECK(run.state().v[0] - 1000 == Approx((1 - std::cos(20.0)) / 20).margin(1e-3));
}

TEST_CASE("damped fast rotations are watched for as translations are", "[mutants]") {
  for (const int component : {0, 2, 3, 5, 9}) {
    StiffnessWatch watch(3.3);
    VecX dv = VecX::Zero(12), a = VecX::Zero(12), a_end = VecX::Constant(12, 1.0);
    dv[component] = 1e-3;
    for (int i = 0; i < 15; ++i) {
      a = a_end;
      a[component] += 33 * dv[component];  // da = -33 dv, in steps of 0.1 s
      watch.observe(0.1, dv, a, a_end, 0.5);
    }
    INFO(component);
    CHECK(watch.stiff());
  }
}

TEST_CASE("a drive by speed starts from the angle beyond the imposed rotation", "[mutants]") {
  System system;
  const Quat turned = axis_angle(Vec3::UnitZ(), 0.5);
  Body& wheel =
      system.add_body("wheel", MassProperties{2, Vec3::Zero(), Vec3(0.2, 0.2, 0.3).asDiagonal()}, {{0, 0, 0}, turned});
  auto& hinge = system.add<Revolute>("hinge", system.add_marker("P", wheel), system.add_marker("S", system.ground()));
  hinge.turn(laws::constant_rotation(turned));
  hinge.drive_speed(Axis::rz, laws::constant(2));
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<Dop853>(), {});
  State start = system.start();
  assemble(dynamics, start);
  run.set_state(start);
  run.run_until(0.5);
  CHECK(rotation_vector(run.state().slot_pose(wheel.slot).q)[2] == Approx(1.5).epsilon(1e-9));
}

TEST_CASE("an imposed rotation and a driven one make the product of both", "[mutants]") {
  const auto tilt = laws::law([](auto t) { return 0.4 * sin(3.0 * t); }),
             spin = laws::law([](auto t) { return 2.0 * t * t; });
  const LawPtr<RotationLaw> first = laws::axis_rotation({1, 0, 0}, tilt);
  VecX a[2];
  for (const bool together : {false, true}) {
    System system;
    Body& wheel = system.add_body("wheel", MassProperties{2, {0.1, 0.2, 0}, Vec3(0.2, 0.3, 0.4).asDiagonal()});
    Marker &P = system.add_marker("P", wheel), &S = system.add_marker("S", system.ground());
    if (together) {
      system.add<Fixed>("joint", P, S).turn(laws::rotation_product(first, laws::axis_rotation({0, 0, 1}, spin)));
    } else {
      auto& hinge = system.add<Revolute>("joint", P, S);
      hinge.turn(first);
      hinge.drive(Axis::rz, spin);
    }
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    State s = system.start();
    s.t = 0.3;
    assemble(dynamics, s);
    a[together] = dynamics.evaluate(s).a;
  }
  CHECK(a[1].norm() > 1);
  CHECK((a[0] - a[1]).norm() < 1e-9 * a[1].norm());
}

TEST_CASE("an event that is due once falls due once", "[mutants]") {
  for (const bool once : {true, false}) {
    Stone stone;
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, method_of("dopri5"), {});
    int met = 0;
    run.add_event({.name = "level",
                   .value = [](const Sample& s) { return s.state.q[2] - 1; },
                   .once = once,
                   .change = [&](State&) { ++met; }});
    run.set_state(stone.thrown(6));  // passes 1 m at 0.2 s and at 1 s
    run.run_until(1.2);
    CHECK(met == (once ? 1 : 2));
  }
}

TEST_CASE("the lengths of all steps add up to the run, events, jumps and outputs or not", "[mutants]") {
  for (const char* name : {"rk4", "dopri5", "dop853", "radau5", "rattle2"}) {
    Stone stone;
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, method_of(name), {.step = 0.11, .output = 0.3});
    run.add_event({.name = "level",
                   .value = [](const Sample& s) { return s.state.q[2] - 1; },
                   .once = false,
                   .change = [](State& s) { s.v[0] += 1; }});
    run.add_event({.name = "instant", .at = 0.537, .change = [](State& s) { s.v[1] += 1; }});
    Lengths lengths;
    run.add_observer(lengths);
    run.set_state(stone.thrown(6));
    run.run_until(1.25);
    INFO(name);
    CHECK(run.state().v[0] == Approx(2));
    CHECK(run.state().v[1] == Approx(1));
    CHECK(lengths.sum == Approx(1.25).epsilon(1e-12));
  }
}

TEST_CASE("a constant force is a potential, and no supply besides", "[mutants]") {
  for (const bool gravity : {false, true}) {
    System system(System::Options{{0, 0, gravity ? -9.81 : 0}});
    Body& body = system.add_body("body", MassProperties{2, Vec3::Zero(), Mat3::Identity()}, {{0.3, 0.1, 0}, {}});
    body.start = {{0.4, 0, 0.1}, {1, 2, 0.5}};
    Marker& off = system.add_marker("off", body, {{0.2, 0, 0.1}, {}});
    system.add(std::make_unique<AppliedForce>("push", off, AppliedForce::Options{.force = {3, -1, 2}}));
    Recorder recorder(system, {"energy.balance", "energy.supplied", "energy.total"});
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    StepLoop run(dynamics, method_of("dop853"), {.tolerance = {1e-10, 1e-12}, .output = 0.1});
    run.add_observer(recorder);
    run.run_until(1);
    CHECK(std::abs(recorder.table().last("energy.balance")) < 1e-8);
    CHECK(std::abs(recorder.table().last("energy.supplied")) < 1e-8);
  }
}

TEST_CASE("a force that leaves the plane in mid-run is rejected by name", "[mutants]") {
  System system;
  Body& body = system.add_body("body", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
  body.start.v = {2000, 0, 0};
  system.add(std::make_unique<Leaving>(system.add_marker("at", body)));
  system.set_planar(Plane{2});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, method_of("dopri5"), {.step = 0.05});
  check_words(message_of<Error>([&] { run.run_until(1); }), {"force 'leaving'", "out of the plane"});
  CHECK(run.state().t <= 0.51);
  CHECK(run.state().t >= 0.4);
}

TEST_CASE("a drive that becomes active next to another one of another speed is rejected", "[mutants]") {
  for (const double speed : {1.0, 2.0}) {  // of the second, which stands where the first is after 1 s
    System system;
    Body& cart = system.add_body("cart", MassProperties{1, Vec3::Zero(), Mat3::Identity()});
    Marker &P = system.add_marker("P", cart), &S = system.add_marker("S", system.ground());
    system.add<Prismatic>("one", P, S).drive(Axis::z, laws::polynomial({0, 1}));
    auto& two = system.add<Prismatic>("two", P, S);
    two.drive(Axis::z, laws::polynomial({1 - speed, speed}));
    two.set_active_at_start(false);
    Dynamics dynamics(system, std::make_unique<SchurSolver>());
    StepLoop run(dynamics, method_of("dopri5"), {});
    run.add_event({.name = "both", .at = 1, .activate = {"two"}});
    State start = system.start();
    assemble(dynamics, start);
    run.set_state(start);
    const std::string refusal = message_of<AssemblyError>([&] { run.run_until(1.5); });
    INFO(refusal);
    CHECK(says(refusal, {"leaves inconsistent velocities"}) == (speed != 1));
    CHECK(run.state().t == (speed == 1 ? 1.5 : 1.0));
  }
}

TEST_CASE("the last output is at the end, though its multiple differs by rounding", "[mutants]") {
  for (const auto& [interval, end, rows] : {std::tuple{0.3, 0.9, 4u}, {0.1, 0.7, 8u}, {0.1, 0.3, 4u}, {0.7, 2.1, 4u}}) {
    Stone stone;
    Recorder recorder(stone.system, {"stone.z"});
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, method_of("dopri5"), {.output = interval});
    run.add_observer(recorder);
    run.run_until(end);
    INFO(interval << ", " << end);
    CHECK(recorder.table().n_rows() == rows);
    CHECK(recorder.table().last("t") == end);
  }
}

TEST_CASE("a run of zero duration has one line", "[mutants]") {
  for (const double interval : {0.0, 0.1}) {
    Stone stone;
    Recorder recorder(stone.system, {"stone.z"});
    Dynamics dynamics = dynamics_of(stone.system);
    StepLoop run(dynamics, method_of("dopri5"), {.output = interval});
    run.add_observer(recorder);
    run.run_until(0);
    CHECK(recorder.table().n_rows() == 1);
    CHECK(run.report().steps == 0);
  }
}

}  // namespace planted_motion_test
