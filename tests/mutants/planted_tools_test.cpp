// SPDX-License-Identifier: BSD-3-Clause
// What slips that were planted in the tools once got past: each test fails with one of tests/mutants/*.patch.
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/kinematics.h>
#include <lockstep/laws.h>
#include <lockstep/linearization.h>
#include <lockstep/modes.h>
#include <lockstep/report.h>
#include <lockstep/scene.h>
#include <lockstep/simulation.h>
#include <lockstep/solvers.h>
#include <lockstep/sweep.h>
#include <lockstep/system.h>
#include "framework/tools/precision/certificate.h"
#include "framework/tools/sweep/step_limit.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/report_page.h"

namespace planted_tools_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

Dynamics dynamics_of(System& system) { return Dynamics(system, std::make_unique<SchurSolver>()); }

MassProperties plate() { return {1, Vec3::Zero(), Vec3(0.1, 0.2, 0.3).asDiagonal()}; }

/// Remembers two numbers, of which it writes one.
class Forgetful final : public Force, public Remembering {
 public:
  explicit Forgetful(const Marker& at) : Force("forgetful"), at_(at) {}
  std::string_view type() const override { return "forgetful"; }
  std::vector<const Marker*> markers() const override { return {&at_}; }
  void setup() override {}
  void apply(const Inputs&, WrenchSum&) const override {}
  const Remembering* remembering() const override { return this; }
  int n_memory() const override { return 2; }
  void start_memory(std::span<double> z) const override { z[0] = 0; }
  void accept_step(const Inputs&, std::span<double>) const override {}

 private:
  const Marker& at_;
};

}  // namespace

TEST_CASE("memory that a force leaves unwritten at the start is an error with its name", "[mutants]") {
  System system;
  Body& body = system.add_body("body", plate());
  system.add(std::make_unique<Forgetful>(system.add_marker("at", body)));
  check_words(message_of<UserCodeError>([&] { dynamics_of(system).evaluate(system.start()); }),
              {"'forgetful'", "start_memory()"});
}

TEST_CASE("dopri5 is stable on the real axis as far as its sixth power allows", "[mutants]") {
  // x'' = -100 x': R(z) = 1 + z + ... + z^5/120 + z^6/600 is -1 or 1 first at z = -3.3066.
  const SmallMotions s{MatX::Zero(1, 1), MatX::Constant(1, 1, -100)};
  Value fixed(Value::Object{});
  fixed.object()->push_back({"fixed", Value(true), {}});
  const double h = step_limit({"dopri5", fixed, {}}, s, 1e-3, 1);
  const auto R = [](double z) {
    const double z2 = z * z, z3 = z2 * z;
    return 1 + z + z2 / 2 + z3 / 6 + z2 * z2 / 24 + z2 * z3 / 120 + z3 * z3 / 600;
  };
  CHECK(std::abs(R(-3.3066)) == Approx(1).epsilon(1e-3));
  CHECK(100 * h == Approx(3.3066).epsilon(2e-3));
}

TEST_CASE("a drive by speed returns over its jumps to its start", "[mutants]") {
  System system;
  Body& wheel = system.add_body("wheel", plate());
  auto& hinge = system.add<Revolute>("hinge", system.add_marker("P", wheel), system.add_marker("S", system.ground()));
  // 1 rad/s, from 0.5 s on 30 rad/s, from 0.51 s on -2 rad/s: a step may go over both jumps
  hinge.drive_speed(Axis::rz,
                    laws::sequence({{0.5, laws::constant(1)}, {0.01, laws::constant(30)}, {5, laws::constant(-2)}}));
  Dynamics dynamics = dynamics_of(system);
  State start = system.start();
  assemble(dynamics, start);
  DrivenMotion motion(dynamics, start);
  const auto angle_at = [&](double t) {
    motion.to(t);
    return rotation_vector(motion.state().slot_pose(wheel.slot).q)[2];
  };
  const auto exact = [](double t) { return t < 0.5 ? t : t < 0.51 ? 0.5 + 30 * (t - 0.5) : 0.8 - 2 * (t - 0.51); };
  for (const double t : {0.4, 0.6, 0.45, 0.505, 0.55, 0.48, 0.8, 0.0})
    CHECK(angle_at(t) == Approx(exact(t)).margin(1e-9));
}

TEST_CASE("a repeat that is not a number agrees in no digit", "[mutants]") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const auto table_of = [](double x) {
    Table table;
    table.add_column("t", "s"), table.add_column("x", "m");
    for (int i = 0; i < 3; ++i) {
      const double row[] = {0.1 * i, i == 1 ? x : 2.0};
      table.add_row(row);
    }
    return table;
  };
  const Table sound = table_of(2);
  for (const double bad : {nan, infinite, -infinite}) {
    const Table other = table_of(bad);
    CHECK(certify(sound, {&other}).channels.at(0).worst().digits == 0);
    CHECK(certify(other, {&sound}).channels.at(0).worst().digits == 0);
  }
}

TEST_CASE("a run of a sweep that drifts beyond the scene's limit is wrong", "[mutants]") {
  const Registry registry = builtin_registry();
  for (const bool narrow : {true, false}) {
    const Scene scene = scene_from_text(std::string(R"({"lockstep": 1, "gravity": [5, -9.81, 0],
          "bodies": [{"name": "left", "rod": {"mass": 1, "from": [0, 0, 0], "to": [0, -1, 0]}},
                     {"name": "right", "rod": {"mass": 1, "from": [1, 0, 0], "to": [1.2, -1, 0]}},
                     {"name": "bar", "rod": {"mass": 1, "from": [0, -1, 0], "to": [1.2, -1, 0]}}],
          "links": [{"name": "A", "type": "revolute", "p": "left", "s": "ground", "at": [0, 0, 0]},
                    {"name": "B", "type": "revolute", "p": "bar", "s": "left", "at": [0, -1, 0]},
                    {"name": "C", "type": "revolute", "p": "bar", "s": "right", "at": [1.2, -1, 0]},
                    {"name": "D", "type": "revolute", "p": "right", "s": "ground", "at": [1, 0, 0]}],
          "run": {"until": 3, "output": 0.1, "integrator": "dopri5", "tolerance": 1e-3,
                  "stabilization": "none", "violation_limit": )") +
                                            (narrow ? "1e-12" : "10") + R"(, "record": ["bar.x"]}})",
                                        "scene.json");
    const std::vector<Variable> variables = read_variables({"bodies.bar.rod.mass=1:4:4"}, scene, registry);
    std::vector<Scene> scenes;
    for (std::size_t k = 0; k < 4; ++k) scenes.push_back(vary_scene(scene, variables, {k}, registry));
    for (const Scene& one : scenes) {
      const SweepRun run = sweep_run(one, registry, recorded_columns(scene, registry));
      CHECK(run.violation > 1e-9);
      CHECK(run.wrong == narrow);
      CHECK(run.drifted == narrow);
    }
  }
}

TEST_CASE("the rate of an input acts through the damper between it and a mass", "[mutants]") {
  // A cart that a law moves along z, and a mass of 2 kg on the same line: 2 y'' = -3 (y' - u') - 50 (y - u).
  System system;
  Body &cart = system.add_body("cart", plate()), &mass = system.add_body("mass", plate(), {{0, 0, 1}, {}});
  Prismatic& rail =
      system.add<Prismatic>("rail", system.add_marker("cart P", cart), system.add_marker("rail S", system.ground()));
  system.add<Prismatic>("line", system.add_marker("mass P", mass), system.add_marker("line S", system.ground()));
  const auto law = std::make_shared<InputLaw>();
  rail.drive(Axis::z, law);
  system.add<SpringDamper>("between", system.add_marker("from", mass), system.add_marker("to", cart),
                           SpringDamper::Options{.stiffness = 50, .damping = 3, .free_length = 1});
  Dynamics dynamics = dynamics_of(system);
  State state = system.start();
  assemble(dynamics, state);
  const StateSpace s = linearize(dynamics, state, {{.name = "u", .unit = "m", .law = law}}, {});
  REQUIRE(s.states.size() == 2);
  REQUIRE(s.inputs.size() == 3);
  CHECK(s.B(1, 0) == Approx(50).epsilon(1e-6));
  CHECK(s.B(1, 1) == Approx(3).epsilon(1e-6));
  CHECK(s.B(1, 2) == Approx(0).margin(1e-9));
  CHECK(s.A(1, 1) == Approx(-3).epsilon(1e-6));
}

TEST_CASE("rotations of a mode are about the world's axes, for all axes of the body", "[mutants]") {
  System system(System::Options{{0, -9.81, 0}});
  const Quat tilted = exponential(Vec3(0.5, -0.7, 0.4));
  const Vec3 axis = Vec3(0.3, 0.2, 1).normalized();
  Body& rod = system.add_body("rod", plate(), {cross(axis, cross(axis, Vec3(0, 1, 0))).normalized(), tilted});
  system.add<Revolute>("hinge", rod, system.ground(), pose_at({0, 0, 0}, axis));
  Dynamics dynamics = dynamics_of(system);
  const Modes found = find_modes(dynamics, system.start(), {});
  REQUIRE(found.modes.size() == 1);
  const Eigen::Vector3cd turn = found.modes[0].shape.at(0).turn;
  CHECK(turn.imag().norm() < 1e-9);
  CHECK(std::abs(turn.real().normalized().dot(axis)) == Approx(1).epsilon(1e-9));
}

TEST_CASE("a report shows of bodies that move as one each one's own speed", "[mutants]") {
  System system;
  const Quat turned = exponential(Vec3(0.2, 0.1, -0.3));
  Body& one = system.add_body("one", plate(), {{0.3, 0, 0}, turned});
  Body& two = system.add_body("two", plate(), {{1.3, 0.4, 0}, {}});
  system.add<Fixed>("bolt", two, one, pose_at({0.8, 0, 0}));
  one.start = {{1, 2, 3}, {0.5, -0.4, 2}};
  const Vec3 w = rotation(turned) * one.start.w;
  two.start = {one.start.v + cross(w, Vec3(1, 0.4, 0)), w};
  system.set_merge(true);
  Simulation run(system, {.output = 0.1});
  run.record({"one.x"});
  Report report(run.recorder());
  run.add_observer(report);
  run.run_until(0.1);
  REQUIRE(one.slot == two.slot);
  const report_page::Page page(report.page());
  const std::vector<double> rows = report_page::read(page.bytes, page.data["frames"]["rows"]);
  REQUIRE(rows.size() >= 26);
  for (std::size_t k = 0; k < 2; ++k) {  // of the first frame
    const Vec3 v = (k == 0 ? one : two).start.v;
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(rows[13 * k + 7 + i] == Approx(v[static_cast<Eigen::Index>(i)]).epsilon(1e-5));
      CHECK(rows[13 * k + 10 + i] == Approx(w[static_cast<Eigen::Index>(i)]).epsilon(1e-5));
    }
  }
}

}  // namespace planted_tools_test
