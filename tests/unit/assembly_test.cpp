// SPDX-License-Identifier: BSD-3-Clause
// Assembly, projection and mobility: from afar, with redundant rows, and what they say when it cannot be.
#include <cmath>
#include <limits>
#include <memory>

#include <lockstep/author/phi_links.h>
#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace assembly_test {

using namespace lockstep;
using lockstep::testing::message_of, lockstep::testing::says;

namespace {

/// A spatial four-bar of revolutes about z: 20 rows, 17 of them independent, one freedom.
System four_bar() {
  System sys;
  Body& crank = sys.add_body("crank", shapes::rod(1.0, {0, 0, 0}, {0, 0.2, 0}));
  Body& bar = sys.add_body("bar", shapes::rod(1.0, {0, 0.2, 0}, {0.5, 0.3, 0}));
  Body& rocker = sys.add_body("rocker", shapes::rod(1.0, {0.5, 0, 0}, {0.5, 0.3, 0}));
  sys.add<Revolute>("A", crank, sys.ground(), pose_at({0, 0, 0}));
  sys.add<Revolute>("B", bar, crank, pose_at({0, 0.2, 0}));
  sys.add<Revolute>("C", bar, rocker, pose_at({0.5, 0.3, 0}));
  sys.add<Revolute>("D", rocker, sys.ground(), pose_at({0.5, 0, 0}));
  return sys;
}

std::unique_ptr<LinearSolver> solver(bool dense) {
  if (dense) return std::make_unique<DenseSolver>();
  return std::make_unique<SchurSolver>();
}

}  // namespace

TEST_CASE("a mechanism of scattered bodies is assembled, with redundant constraints or not", "[unit][analysis]") {
  const bool dense = GENERATE(true, false);
  System sys = four_bar();
  Dynamics dynamics(sys, solver(dense));
  State state = sys.start();
  // moved by decimetres, turned by most of a radian, out of its plane too
  const double shift[] = {0.3, -0.2, 0.1};
  for (int k = 0; k < 3; ++k) {
    state.q.segment<3>(7 * k) += Vec3(shift[k], 0.15, -shift[k]);
    const Quat q = Quat::from(state.q.segment<4>(7 * k + 3)) * exponential(Vec3(0.5 * shift[k], 0.4, -0.6));
    state.q.segment<4>(7 * k + 3) = q.coefficients();
  }
  state.v.setConstant(0.7);
  const AssemblyReport report = assemble(dynamics, state);
  CHECK(report.before > 0.1);
  CHECK(report.after < 1e-12);
  CHECK(dynamics.violation(state) < 1e-12);
  CHECK(dynamics.violation_v(state) < 1e-10);
  CHECK(report.largest_move > 0.1);
  CHECK_FALSE(report.moved_most.empty());
}

TEST_CASE("one joint is assembled from any error below half a revolution", "[unit][analysis]") {
  const double angle = GENERATE(1.0, 2.5, 3.0, 3.1);
  System sys;
  Body& body = sys.add_body("body", shapes::box(1.0, {0.1, 0.2, 0.3}));
  sys.add<Fixed>("hold", body, sys.ground(), pose_at({0, 0, 0}));
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  State state = sys.start();
  state.q.segment<4>(3) = axis_angle(Vec3(1, 2, -1), angle).coefficients();
  const AssemblyReport report = assemble(dynamics, state);
  CHECK(report.iterations <= 2);  // (8.2): the Cayley update takes the whole error away at once
  CHECK(report.after < 1e-12);
}

TEST_CASE("an impossible assembly names the violated constraints, and the state remains unchanged",
          "[unit][analysis]") {
  System sys;
  Body& body = sys.add_body("body", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  sys.add<Spherical>("left", body, sys.ground(), pose_at({0, 0, 0}));
  Marker& end = sys.add_marker_at("end", body, {{1, 0, 0}, {}});
  sys.add<Spherical>("right", end, sys.add_marker("far", sys.ground(), {{1.5, 0, 0}, {}}));  // the rod is too short
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State state = sys.start();
  const State before = state;
  const std::string message = message_of<AssemblyError>([&] { assemble(dynamics, state); });
  CHECK(says(message,
             {"assembly stopped", "worst: constraint x of joint", "check the positions and axes of these joints"}));
  CHECK(state.q == before.q);
}

TEST_CASE("a law that is not a number is named by assembly and by a run", "[unit][analysis]") {
  const auto sick =
      laws::law([](auto t) { return t < 0.5 ? 0.1 * sin(t) : std::numeric_limits<double>::quiet_NaN() * t; });
  System sys;
  Body& body = sys.add_body("body", shapes::box(1.0, {0.1, 0.2, 0.3}));
  auto& slide = sys.add<Prismatic>("slide", body, sys.ground(), pose_at({0, 0, 0}));
  slide.drive(Axis::z, sick);
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State start = sys.start();
  assemble(dynamics, start);
  SECTION("in a run, with what was computed kept") {
    Recorder recorder(sys, {"body.z"});
    StepLoopOptions options;
    options.step = 0.01;
    StepLoop run(dynamics, std::make_unique<Rk4>(), options);
    run.set_state(start);
    run.add_observer(recorder);
    const std::string message = message_of<NonFiniteError>([&] { run.run_until(1.0); });
    CHECK(says(message, {"joint 'slide'", "the law of drive z", "t = 0.5"}));
    CHECK(recorder.table().n_rows() > 40);
  }
  SECTION("with error control too: it does not creep towards it for ever, nor look beyond the run for its first step") {
    Recorder recorder(sys, {"body.z"});
    StepLoop run(dynamics, std::make_unique<Dopri5>());
    run.set_state(start);
    run.add_observer(recorder);
    const std::string message = message_of<NonFiniteError>([&] { run.run_until(1.0); });
    CHECK(says(message, {"joint 'slide'", "the law of drive z"}));
    CHECK(recorder.table().last("t") > 0.4);
    CHECK(recorder.table().last("t") < 0.5);
  }
  SECTION("at the start") {
    State late = start;
    late.t = 0.6;
    const std::string message = message_of<NonFiniteError>([&] { assemble(dynamics, late); });
    CHECK(says(message, {"joint 'slide'", "the law of drive z"}));
  }
}

TEST_CASE("projection moves the least in the mass metric", "[unit][dynamics]") {
  // Two bodies on one prismatic axis z, held at one point by a distance... here: tied together by a lock on z alone. An
  // error e in z is shared in the inverse ratio of the masses.
  System sys;
  Body& light = sys.add_body("light", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  Body& heavy = sys.add_body("heavy", MassProperties{3.0, Vec3::Zero(), Mat3::Identity()});
  Marker& P = sys.add_marker("P", light);
  Marker& S = sys.add_marker("S", heavy);
  sys.add<PointOnPlane>("tie", P, S);
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State state = sys.start();
  state.q[2] = 0.04;  // z of the light one
  state.v[2] = 0.8;
  const ProjectReport report = dynamics.project(state);
  CHECK(std::abs(report.before - 0.04) < 1e-15);
  CHECK(report.converged);
  CHECK(std::abs(state.q[2] - 0.01) < 1e-12);  // 3/4 of the way
  CHECK(std::abs(state.q[9] - 0.01) < 1e-12);  // 1/4
  CHECK(std::abs(state.v[2] - 0.2) < 1e-12);   // momentum is kept
  CHECK(std::abs(state.v[8] - 0.2) < 1e-12);
}

TEST_CASE("degrees of freedom and redundant constraints are reported by name", "[unit][analysis]") {
  System sys = four_bar();
  Body& free = sys.add_body("free", shapes::box(1.0, {1, 1, 1}));
  sys.add<Spherical>("ball", free, sys.ground(), pose_at({3, 0, 0}));
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  State state = sys.start();
  assemble(dynamics, state);
  const MobilityReport m = mobility(dynamics, state);
  CHECK(m.bodies == 4);
  CHECK(m.unknowns == 24);
  CHECK(m.rows == 23);
  CHECK(m.rank == 20);
  CHECK(m.freedoms == 4);
  CHECK(m.redundant == 3);
  CHECK(m.redundant_links == std::vector<std::string>{"A", "B", "C", "D"});
}

TEST_CASE("degrees of freedom of a tree are counted joint by joint, for trees of any size", "[unit][dynamics]") {
  constexpr int kBodies = 3000;  // a decomposition of all rows would take hours
  System sys;
  Body* last = &sys.ground();
  for (int k = 0; k < kBodies; ++k) {
    const std::string name = std::to_string(k);
    Body& body = sys.add_body("body" + name, shapes::rod(1.0, {double(k), 0, 0}, {k + 1.0, 0, 0}));
    sys.add<Revolute>("joint" + name, body, *last, pose_at({double(k), 0, 0}, Vec3(0.1 * k, 1, 0)));
    last = &body;
  }
  sys.setup();
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  const MobilityReport m = mobility(dynamics, sys.start());
  CHECK(m.rows == 5 * kBodies);
  CHECK(m.rank == 5 * kBodies);
  CHECK(m.freedoms == kBodies);
  CHECK(m.redundant == 0);
  CHECK(m.redundant_links.empty());

  // Half a turn off its hinge, about x: the row e1 has no gradient there.
  System one;
  Body& arm = one.add_body("arm", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  one.add<Revolute>("hinge", arm, one.ground(), pose_at({0, 0, 0}));
  one.setup();
  Dynamics of_one(one, std::make_unique<SchurSolver>());
  State flipped = one.start();
  CHECK(mobility(of_one, flipped).freedoms == 1);
  Pose pose = flipped.slot_pose(0);
  pose.q = Quat{0, 1, 0, 0} * pose.q;
  flipped.set_slot_pose(0, pose);
  const MobilityReport off = mobility(of_one, flipped);
  CHECK(off.rank == 4);
  CHECK(off.redundant_links == std::vector<std::string>{"hinge"});
}

namespace {

// Holds x at 0.2 m, in numbers that say little of metres.
struct Faint {
  static constexpr PhiSpec spec{};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 1e-6 * (y.x - 0.2);
  }
};
class FaintLink final : public PhiLock<Faint> {
 public:
  FaintLink(std::string name, Marker& p, Marker& s)
      : PhiLock<Faint>(std::move(name), p, s, Mask::y | Mask::z | Mask::e1 | Mask::e2 | Mask::e3, Faint{}) {}
  std::string_view type() const override { return "faint"; }
};

}  // namespace

TEST_CASE("a start is as far off as the nearest pose that fits, however small the gradient of a function",
          "[unit][analysis]") {
  System sys;
  Body& body = sys.add_body("slider", shapes::box(1.0, {1, 1, 1}));
  sys.add<FaintLink>("faint", sys.add_marker("p", body), sys.add_marker("s", sys.ground()));
  Dynamics dynamics(sys, std::make_unique<DenseSolver>());
  State state = sys.start();
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  CHECK(says(message_of<AssemblyError>([&] { run.run_until(0.1); }),
             {"violates the constraints by 0.2 m", "constraint phi of joint 'faint'", "assemble it first"}));
  const AssemblyReport report = assemble(dynamics, state);
  CHECK(report.before == Approx(0.2).epsilon(1e-9));
  CHECK(report.after < 1e-9);
  CHECK(report.largest_move == Approx(0.2).epsilon(1e-9));
  CHECK(report.is_notable());
  CHECK(state.q[0] == Approx(0.2).epsilon(1e-9));
}

TEST_CASE("a system that grew is set up again, and an earlier state is rejected", "[unit][dynamics]") {
  System sys = four_bar();
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  const State old = sys.start();
  dynamics.evaluate(old);
  sys.add_body("late", shapes::box(1.0, {1, 1, 1}));
  CHECK(says(message_of<ModelError>([&] { sys.start(); }), {"not set up", "setup()"}));
  sys.setup();
  CHECK(says(message_of<ModelError>([&] { dynamics.evaluate(old); }),
             {"does not fit", "4 moving bodies", "System::start"}));
  CHECK(dynamics.evaluate(sys.start()).a.size() == 24);
}

TEST_CASE("two laws on one coordinate are distinguished by name", "[unit][analysis]") {
  System sys;
  Body& body = sys.add_body("wheel", shapes::box(1.0, {0.1, 0.2, 0.3}));
  sys.add<Revolute>("slow", body, sys.ground(), pose_at({0, 0, 0})).drive(Axis::rz, laws::ramp(1.0));
  sys.add<Revolute>("fast", body, sys.ground(), pose_at({0, 0, 0})).drive(Axis::rz, laws::ramp(2.0));
  Dynamics dynamics(sys, std::make_unique<SchurSolver>());
  State state = sys.start();
  const std::string message = message_of<AssemblyError>([&] { assemble(dynamics, state); });
  CHECK(says(message, {"inconsistent velocities: they violate the constraints", "constraint e3 of joint",
                       "two laws may drive one coordinate"}));
}

TEST_CASE("a start speed is met to round-off with every solver", "[unit][analysis]") {
  const int which = GENERATE(0, 1, 2);
  const auto make = [&]() -> std::unique_ptr<LinearSolver> {
    if (which == 0) return std::make_unique<SchurSolver>();
    if (which == 1) return std::make_unique<SparseSolver>();
    return std::make_unique<DenseSolver>();
  };
  System sys = four_bar();
  Dynamics dynamics(sys, make());
  State state = sys.start();
  assemble(dynamics, state, {{"A", Axis::rz, 7.5}});
  CAPTURE(which);
  CHECK(std::abs(state.v.segment<3>(3).norm() - 7.5) < 1e-14);
  CHECK(dynamics.violation_v(state) < 1e-13);
}

TEST_CASE("assembly warns of what was hardly meant, and of whom no velocity is given", "[unit][analysis]") {
  System sys = four_bar();
  Dynamics dynamics(sys, solver(true));
  SECTION("the energy of one body's velocity is shared out") {
    sys.body("crank").start.w = rotation(sys.body("crank").home.q).transpose() * Vec3(0, 0, 5);
    sys.body("crank").start.v = cross(Vec3(0, 0, 5), sys.body("crank").home.x);
    State state = sys.start();
    const AssemblyReport report = assemble(dynamics, state);
    CHECK(report.kinetic_before == Approx(0.5 * 25 * 0.04 / 3).epsilon(1e-3));  // a rod about its end
    CHECK(report.kinetic_after < 0.5 * report.kinetic_before);
    REQUIRE(report.findings.size() == 1);
    CHECK(says(report.findings.front().text(), {"J of the", "'bar'", "'rocker'"}));
    CHECK_FALSE(says(report.findings.front().text(), {"'crank'"}));
    CHECK(says(report.text(), {"kinetic energy"}));
  }
  SECTION("half of a body's velocity is given") {  // a rod on a hinge at its end: J = m l^2/12 + m l^2/4
    System own;
    Body& arm = own.add_body("arm", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    own.add<Revolute>("A", arm, own.ground(), pose_at({0, 0, 0}));
    Dynamics one(own, solver(true));
    const Vec3 omega = rotation(arm.home.q).transpose() * Vec3(0, 0, 1);
    SECTION("the angular one") {
      arm.start = {Vec3::Zero(), omega};
      State state = own.start();
      const AssemblyReport report = assemble(one, state);
      CHECK(report.kinetic_after == Approx(report.kinetic_before / 4).epsilon(1e-3));
      REQUIRE(report.findings.size() == 1);
      CHECK(says(report.findings.front().text(),
                 {"no \"velocity\" of the frame's origin is given for 'arm'", "\"start\""}));
      CHECK_FALSE(says(report.findings.front().text(), {"no free motion has this direction"}));
    }
    SECTION("that of the origin") {
      arm.start = {Vec3(0, 0.5, 0), Vec3::Zero()};
      State state = own.start();
      const AssemblyReport report = assemble(one, state);
      CHECK(report.kinetic_after == Approx(0.75 * report.kinetic_before).epsilon(1e-3));
      REQUIRE(report.findings.size() == 1);
      CHECK(says(report.findings.front().text(), {"no angular velocity (\"omega_world\") is given for 'arm'"}));
    }
    SECTION("both") {
      arm.start = {Vec3(0, 0.5, 0), omega};
      State state = own.start();
      const AssemblyReport report = assemble(one, state);
      CHECK(report.findings.empty());
      CHECK_FALSE(says(report.text(), {"kinetic energy"}));  // it stays as it is
    }
    SECTION("one about an axis that is not free") {
      arm.start = {Vec3::Zero(), rotation(arm.home.q).transpose() * Vec3(0, 1, 0)};
      State state = own.start();
      const AssemblyReport report = assemble(one, state);
      REQUIRE(report.findings.size() == 1);
      CHECK(says(report.findings.front().text(), {"no free motion has this direction"}));
    }
  }
  SECTION("a body far from where it was put") {
    State state = sys.start();
    state.q.segment<3>(7 * sys.body("bar").slot) += Vec3(0.6, 0, 0);
    const AssemblyReport report = assemble(dynamics, state);
    REQUIRE(report.findings.size() == 1);
    CHECK(says(report.findings.front().text(),
               {"the given poses do not fit the joints: assembly moved '", "lockstep assemble prints those it finds"}));
  }
  SECTION("a joint that alone is drawn open") {
    System own;
    Body& arm = own.add_body("arm", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    own.add<Spherical>("A", own.add_marker("P", arm, Pose{{1, 0, 0}, {}}), own.add_marker("S", own.ground(), Pose{}));
    Dynamics one(own, solver(true));
    State state = own.start();
    const AssemblyReport report = assemble(one, state);
    REQUIRE(report.findings.size() == 1);
    CHECK(says(report.findings.front().text(),
               {"the given poses violate joint 'A' by 1.5 m", "attached to its two bodies"}));
  }
  SECTION("drawn in its zero position, and taken by a law to where it begins") {
    System own;
    Body& arm = own.add_body("arm", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
    own.add<Revolute>("A", arm, own.ground(), pose_at({0, 0, 0})).drive(Axis::rz, laws::constant(1.0));
    Dynamics driven(own, solver(true));
    State state = own.start();
    const AssemblyReport report = assemble(driven, state);
    CHECK(report.largest_turn > 0.9);
    CHECK(report.findings.empty());
  }
  SECTION("a sound start") {
    State state = sys.start();
    assemble(dynamics, state, {{"A", Axis::rz, 7.5}});
    CHECK(assemble(dynamics, state).findings.empty());
  }
}

}  // namespace assembly_test
