// SPDX-License-Identifier: BSD-3-Clause
// Fully driven mechanisms from pose to pose, against trusted histories and against runs; accounts that sum up; branches.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/branches.h>
#include <lockstep/explain.h>
#include <lockstep/kinematics.h>
#include <lockstep/lockstep.h>
#include "framework/tools/scene_run/scene_run.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/run_scene.h"
#include "tests/support/worst.h"

namespace kinematics_test {

using namespace lockstep;

namespace {

/// A scene of samples/scenes with its dynamics, assembled.
struct Driven {
  Mechanism m;
  std::unique_ptr<Recorder> recorder;  // before the start: columns of angles are states
  Dynamics dynamics;
  State start;

  explicit Driven(const std::string& scene, const std::function<void(Scene&)>& change = {})
      : m(build_mechanism(changed(scene, change), builtin_registry())),
        recorder(make_recorder(m)),
        dynamics(system_of(m), make_solver(m.run, builtin_registry()), {m.run.formulation, m.run.stabilization}),
        start(m.system.start()) {
    assemble(dynamics, start, m.start_speeds);
  }
  static Scene changed(const std::string& name, const std::function<void(Scene&)>& change) {
    Scene scene = read_scene(scene_path(name));
    if (change) change(scene);
    return scene;
  }
};

/// The recorded columns at the instants of the trusted history.
Table follow(Driven& d, const Table& at) {
  DrivenMotion motion(d.dynamics, d.start);
  const StepReport report;
  bool first = true;
  for (const double t : at["t"]) {
    motion.to(t);
    const Sample sample(d.dynamics, motion.state(), report);
    if (first)
      d.recorder->start(sample);
    else
      d.recorder->step(sample);
    d.recorder->output(sample);
    first = false;
  }
  return d.recorder->table();
}

}  // namespace

TEST_CASE("kinematics: driven references, motion and reactions, without integration", "[verification][kinematics]") {
  const std::string name = GENERATE("four_bar", "slider_crank", "peaucellier", "hooke_single", "hooke_double", "oldham",
                                    "robot_arm", "prismatic_law");
  CAPTURE(name);
  Driven d(name);
  const Table truth = trusted(name);
  const std::vector<ColumnError> errors = compare(follow(d, truth), truth);
  CHECK(errors.size() > 3);
  for (const ColumnError& e : errors) {
    CAPTURE(e.name, e.error, e.size);
    CHECK(e.error <= 1e-9 * std::max(1.0, e.size));
  }
}

TEST_CASE("kinematics: a drive by speed is integrated by Gauss and Legendre", "[verification][kinematics]") {
  System sys;
  Body& arm = sys.add_body("arm", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
  sys.add<Revolute>("A", arm, sys.ground(), pose_at(Vec3::Zero())).drive_speed(Axis::rz, laws::law([](auto t) {
                                                                                 return 2.0 + cos(3.0 * t);
                                                                               }));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  DrivenMotion motion(dynamics, sys.start());
  for (const double t : {0.3, 0.7, 1.1, 0.9}) {  // back too
    const Solution& v = motion.to(t);
    const Vec3 x = rotation(body_pose(arm, motion.state()).q).col(0);
    const double angle = 2 * t + std::sin(3 * t) / 3;
    CHECK((x - Vec3(std::cos(angle), std::sin(angle), 0)).norm() <= 1e-9);
    CHECK(v.in.slot(arm.slot).w[2] == Approx(2 + std::cos(3 * t)).epsilon(1e-12));
    CHECK(v.a[6 * arm.slot + 5] == Approx(-3 * std::sin(3 * t)).epsilon(1e-10));
  }
}

TEST_CASE("kinematics: too few drives are named with coordinates that would do, too many with those to release",
          "[verification][kinematics]") {
  Driven few("double_pendulum");
  const DriveReport report = driven_by(few.dynamics, few.start);
  CHECK(report.freedoms == 2);
  CHECK(report.to_drive.size() == 2);
  CHECK(report.free.size() == 2);
  for (const std::string& coordinate : report.to_drive) CHECK(coordinate.ends_with(".rz"));
  const std::string words = testing::message_of<ModelError>([&] { DrivenMotion(few.dynamics, few.start); });
  CHECK(words.find("2 free motions") != std::string::npos);
  CHECK(words.find("Drive " + report.to_drive[0]) != std::string::npos);

  Driven four_bar("four_bar");
  const double speed = body_twist(four_bar.m.system.body("rocker"), four_bar.start).w[2];
  Driven many("four_bar", [&](Scene& scene) {
    for (auto& [key, value, where] : *scene.root.object())
      if (key == "links")
        value.list()->back().object()->push_back(
            {"drive",
             Value(Value::Object{
                 {"axis", Value("rz"), {}},
                 {"law", Value(Value::Object{{"type", Value("ramp"), {}}, {"slope", Value(speed), {}}}), {}}}),
             {}});
  });
  const DriveReport too_many = driven_by(many.dynamics, many.start);
  CHECK(too_many.freedoms == 0);
  REQUIRE(too_many.too_many.size() == 1);
  CHECK(too_many.too_many.front() == std::vector<std::string>{"A.rz", "D.rz"});
  CHECK(too_many.text().find("A.rz and D.rz") != std::string::npos);
}

// The hinges of a locked triangle turn by the rounding of the basis, some 1e-17: that is no motion.
TEST_CASE("kinematics: what is locked is not named as what moves, in any order of bodies and links",
          "[verification][kinematics]") {
  const bool locked_first = GENERATE(true, false);
  CAPTURE(locked_first);
  const Vec3 apex(0.4, 1, 0);
  const auto triangle = [&](System& sys) {
    Body& t1 = sys.add_body("t1", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
    Body& t2 = sys.add_body("t2", shapes::rod(1.0, Vec3(1, 0, 0), apex));
    sys.add<Revolute>("J1", t1, sys.ground(), pose_at(Vec3::Zero()));
    sys.add<Revolute>("J2", t2, t1, pose_at(Vec3(1, 0, 0)));
    sys.add<Revolute>("J3", t2, sys.ground(), pose_at(apex));
  };
  SECTION("a triangle of rods with a pendulum") {
    System sys;
    if (locked_first) triangle(sys);
    Body& pend = sys.add_body("pend", shapes::rod(1.0, apex, Vec3(1.4, 1.2, 0)));
    if (!locked_first) triangle(sys);
    sys.add<Revolute>("J4", pend, sys.body("t2"), pose_at(apex));
    Dynamics dynamics(sys, std::make_unique<SchurSolver>());
    State start = sys.start();
    assemble(dynamics, start);
    const DriveReport report = driven_by(dynamics, start);
    CHECK(report.freedoms == 1);
    CHECK(report.to_drive == std::vector<std::string>{"J4.rz"});
    REQUIRE(report.free.size() == 1);
    CHECK(report.free.front().starts_with("'pend' rotates about "));
    CHECK(report.free.front().find("follow") == std::string::npos);
  }
  SECTION("a rod that a distance holds, and a slider") {
    System sys;
    const auto held = [&] {
      Body& a = sys.add_body("a", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
      sys.add<Revolute>("A", a, sys.ground(), pose_at(Vec3::Zero()));
      sys.add<Distance>("L", sys.add_marker_at("tip", a, pose_at(Vec3(1, 0, 0))),
                        sys.add_marker("far", sys.ground(), pose_at(Vec3(1.5, 1, 0))), std::sqrt(1.25));
    };
    if (locked_first) held();
    Body& b = sys.add_body("b", shapes::rod(1.0, Vec3(0, 1, 0), Vec3(1, 1, 0)));
    sys.add<Prismatic>("B", b, sys.ground(), pose_at(Vec3(0, 1, 0), Vec3(1, 0, 0)));
    if (!locked_first) held();
    Dynamics dynamics(sys, std::make_unique<SchurSolver>());
    State start = sys.start();
    assemble(dynamics, start);
    const DriveReport report = driven_by(dynamics, start);
    CHECK(report.freedoms == 1);
    CHECK(report.to_drive == std::vector<std::string>{"B.z"});
    REQUIRE(report.free.size() == 1);
    CHECK(report.free.front().starts_with("'b' moves along "));
    CHECK(report.free.front().find("follow") == std::string::npos);
  }
}

// A crank that is to turn past where rod and rocker are in line.
TEST_CASE("kinematics: if the mechanism does not reach a pose, the time and the constraint are named",
          "[verification][kinematics]") {
  System sys;
  Body& crank = sys.add_body("crank", shapes::rod(1.0, Vec3::Zero(), Vec3(1, 0, 0)));
  Body& rod = sys.add_body("rod", shapes::rod(1.0, Vec3(1, 0, 0), Vec3(1, 1, 0)));
  Body& rocker = sys.add_body("rocker", shapes::rod(1.0, Vec3(2, 0, 0), Vec3(1, 1, 0)));
  sys.add<Revolute>("A", crank, sys.ground(), pose_at(Vec3::Zero())).drive(Axis::rz, laws::law([](auto t) {
                                                                             return 1.0 * t;
                                                                           }));
  sys.add<Revolute>("B", rod, crank, pose_at(Vec3(1, 0, 0)));
  sys.add<Revolute>("C", rocker, rod, pose_at(Vec3(1, 1, 0)));
  sys.add<Revolute>("D", rocker, sys.ground(), pose_at(Vec3(2, 0, 0)));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  DrivenMotion motion(dynamics, sys.start());
  // |B - D| <= 1 + sqrt 2 for B on the circle of radius 1 about A: 5 - 4 cos(t) = (1 + sqrt 2)^2
  const double limit = std::acos((5 - std::pow(1 + std::sqrt(2.0), 2)) / 4);
  CHECK_NOTHROW(motion.to(limit - 1e-3));
  const std::string words = testing::message_of<AssemblyError>([&] { motion.to(limit + 0.1); });
  CHECK(words.find("kinematics stopped at t = 1.7") != std::string::npos);
  CHECK(words.find("worst: constraint") != std::string::npos);
  CHECK(motion.state().t <= limit);
}

TEST_CASE("kinematics: nothing is allocated from pose to pose", "[verification][kinematics]") {
  if (!allocations_are_counted()) return;
  Driven d("four_bar");
  DrivenMotion motion(d.dynamics, d.start);
  for (int k = 1; k <= 5; ++k) motion.to(1e-3 * k);
  CHECK(allocations_of([&] {
          for (int k = 6; k <= 500; ++k) motion.to(1e-3 * k);
        }) == 0);
}

TEST_CASE("explain: all that acts on each body sums to m a and the rate of its angular momentum",
          "[verification][explain]") {
  const std::string name =
      GENERATE("four_bar", "stewart", "flyball", "heavy_top", "spatial_slider_crank", "gear_train");
  CAPTURE(name);
  Driven d(name);
  // One run through the instants 0.05 s - 3 h to 0.05 s + 3 h: its errors do not jump between them.
  const double h = 2e-4;
  StepLoop sim(d.dynamics, make_integrator(d.m.run, builtin_registry()),
               {.step = d.m.run.step, .tolerance = Tolerance{.relative = 1e-12, .atol_x = 1e-14}});
  sim.set_state(d.start);
  std::vector<State> states;
  for (int k = -3; k <= 3; ++k) {
    sim.run_until(0.05 + k * h);
    states.push_back(sim.state());
    d.dynamics.to_slots(states.back());
  }
  const State& state = states[3];
  for (const Body& body : d.m.system.bodies()) {
    if (body.fixed) continue;
    CAPTURE(body.name);
    const BodyBalance b = balance_of(d.dynamics, state, body);
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    double size = 1, turning = 1;
    for (const Contribution& c : b.parts) {
      force += c.force, moment += c.moment;
      keep_worst(size, c.force.norm()), keep_worst(turning, c.moment.norm());
    }
    CHECK(b.parts.size() >= 2);
    // The rates by differences of sixth order of the run itself.
    Vec3 p_d = Vec3::Zero(), l_d = Vec3::Zero();
    for (std::size_t k = 0; k < 7; ++k) {
      constexpr double kWeights[] = {-1, 9, -45, 0, 45, -9, 1};
      const Motion m = slot_motion(states[k], body.slot);
      const Slot& slot = d.m.system.slot(body.slot);
      p_d += kWeights[k] / (60 * h) * slot.mass * m.v, l_d += kWeights[k] / (60 * h) * (m.A * (slot.J * m.w));
    }
    CHECK((b.sum.force - force).norm() <= 1e-12 * size);
    if (!d.m.system.plane()) {
      CHECK((force - p_d).norm() <= 1e-7 * size);
      CHECK((moment - l_d).norm() <= 1e-7 * turning);
    }
    CHECK(b.left_force <= 1e-9 * size);
    CHECK(b.left_moment <= 1e-9 * turning);
  }
}

TEST_CASE("explain: a joint with its constraints, its law, and its redundancy", "[verification][explain]") {
  Driven d("four_bar", [](Scene& scene) { scene = in_space(scene); });
  const double t = 0.1;
  DrivenMotion motion(d.dynamics, d.start);
  motion.to(t);
  const LinkAccount a = account_of(d.dynamics, motion.state(), d.m.system.link("A"));
  CHECK(a.on_p == "crank");
  CHECK(a.on_s == "ground");
  CHECK(a.in_force);
  CHECK(a.rows.size() == 6);
  REQUIRE(a.laws.size() == 1);
  CHECK(a.laws.front().value.front() == Approx(10 * t).epsilon(1e-14));
  CHECK(a.laws.front().rate.front() == 10);
  CHECK(a.laws.front().second.front() == 0);
  REQUIRE(a.dependencies.size() == 1);
  CHECK(a.dependencies.front().too_many == 3);
  LinkWrench sum;  // axes of S
  for (const RowAccount& r : a.rows) {
    CHECK(std::abs(r.value) <= 1e-10);
    sum.force += r.on_p.force, sum.moment += r.on_p.moment;
  }
  REQUIRE(a.axes.size() == 3);
  for (int k = 0; k < 3; ++k) {
    CHECK(std::abs(sum.force[k] - a.axes[k].dot(a.joint.force + a.drives.force)) <= 1e-9);
    CHECK(std::abs(sum.moment[k] - a.axes[k].dot(a.joint.moment + a.drives.moment)) <= 1e-9);
  }
  CHECK(a.rows.back().is_drive);
  CHECK(std::abs(a.rows.back().on_p.moment[2] + a.rows.back().multiplier / 2) <= 1e-9);
}

TEST_CASE("branches: a driven four-bar has two, and they are where circles meet", "[verification][branches]") {
  Driven d("four_bar");
  const BranchReport report = find_branches(d.dynamics, d.start);
  REQUIRE(report.branches.size() == 2);
  CHECK(report.starts == 201);
  CHECK(report.branches[0].found + report.branches[1].found + report.failed == report.starts);
  const Vec3 B(0.1 * std::cos(0.3), 0.1 * std::sin(0.3), 0), D(0.28, 0, 0), BD = D - B;
  const double l = BD.norm(), along = (0.09 - 0.0625 + l * l) / (2 * l), up = std::sqrt(0.09 - along * along);
  const Vec3 e = BD / l, n(-e[1], e[0], 0);
  for (const double side : {1.0, -1.0}) {
    const Vec3 C = B + along * e + side * up * n;
    const auto at = [&](const AssemblyBranch& b) {
      const Pose p = body_pose(d.m.system.body("coupler"), b.state);
      return (p.x + rotation(p.q) * Vec3(0.3, 0, 0) - C).norm();
    };
    CHECK(std::min(at(report.branches[0]), at(report.branches[1])) <= 1e-10);
  }
  // Its rhombus folds flat, and its arms then turn as they like: one entry, however many such positions are met.
  Driven folds("peaucellier");
  const BranchReport folded = find_branches(folds.dynamics, folds.start);
  const auto loose = [](const AssemblyBranch& b) { return b.freedoms > 0; };
  CHECK(std::ranges::count_if(folded.branches, loose) == 1);
  CHECK(std::ranges::find_if(folded.branches, loose)->found > 10);
  Driven free("double_pendulum");
  testing::check_words(testing::message_of<ModelError>([&] { find_branches(free.dynamics, free.start); }),
                       {"a fully driven mechanism"});
}

}  // namespace kinematics_test
