// SPDX-License-Identifier: BSD-3-Clause
// The system: names, set-up, slots, groups, links out of force, and a gather that asks for no memory.
#include <lockstep/author/passes.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/messages.h"

namespace system_test {

using lockstep::testing::check_words, lockstep::testing::message_of, lockstep::testing::says;

using namespace lockstep;
using namespace lockstep::inputs;

namespace {

const MassProperties kMass{2.0, Vec3(0.1, -0.2, 0.3), Vec3(1, 1.2, 1.4).asDiagonal()};

/// A link of one row that says where it was gathered and together with how many.
class Counting : public Lock {
 public:
  Counting(std::string name, Marker& p, Marker& s, unsigned pattern = 0)
      : Lock(std::move(name)), p_(&p), s_(&s), pattern_(pattern) {}
  std::string_view type() const override { return "counting"; }
  std::vector<std::pair<const Marker*, const Marker*>> pairs() const override { return {{p_, s_}}; }
  RowPlan plan_rows() override {
    ++n_setups;
    RowPlan plan;
    plan.add({RowKind::function, "row"});
    plan.slots.add(p_->body->slot), plan.slots.add(s_->body->slot);
    plan.pattern.laws = pattern_;
    return plan;
  }
  void gather(Group links, const Inputs&, RowSpan out) const override {
    ++n_calls;
    most_lanes = std::max(most_lanes, links.size());
    for (std::size_t i = 0; i < links.size(); ++i) {
      const auto& link = static_cast<const Counting&>(*links[i]);
      const RowBlock block = out.lane(i);
      block.C(0) = link.number(), block.Ct(0) = 0, block.Qhat(0) = 0;
      for (int k = 0; k < link.slots().n; ++k) block.set(k, 0, Vec3::Zero(), Vec3::Zero());
    }
  }

  int n_setups = 0;
  static inline int n_calls = 0;
  static inline std::size_t most_lanes = 0;

 private:
  Marker *p_, *s_;
  unsigned pattern_;
};
class OtherCounting final : public Counting {
 public:
  using Counting::Counting;
};

}  // namespace

TEST_CASE("a name is given once, for objects of all kinds", "[unit][system]") {
  System system;
  Body& b = system.add_body("crank", kMass);
  const auto refused = [&](auto&& act) { return message_of<ModelError>(act); };
  CHECK(says(refused([&] { system.add_body("crank", kMass); }), {"body 'crank'", "taken by a body", "choose another"}));
  CHECK(says(refused([&] { system.add_particle("crank", 1, Vec3::Zero()); }), {"body 'crank'", "taken"}));
  CHECK(says(refused([&] { system.add_fixed("ground"); }), {"body 'ground'", "taken"}));
  CHECK(says(refused([&] { system.add_marker("crank", b); }), {"marker 'crank'", "taken by a body"}));
  system.add<Revolute>("hinge", b, system.ground(), pose_at(Vec3::Zero()));
  CHECK(says(refused([&] { system.add_marker("hinge.P", b); }), {"marker 'hinge.P'", "taken by a marker"}));
  CHECK(says(refused([&] { system.add_body("hinge", kMass); }), {"body 'hinge'", "taken by a joint"}));
  CHECK(says(refused([&] { system.add_body("", kMass); }), {"without a name", "give it one"}));
  CHECK(system.bodies().size() == 2);  // nothing that was refused stayed
  CHECK(system.markers().size() == 2);
}

TEST_CASE("every one of many names is known, and taken", "[unit][system]") {
  System system;
  std::vector<Body*> bodies;
  for (int k = 0; k < 500; ++k) {
    const std::string name = "body" + std::to_string(k);
    bodies.push_back(&system.add_body(name, kMass));
    system.add<Revolute>("hinge" + std::to_string(k), *bodies.back(), system.ground(), pose_at(Vec3::Zero()));
  }
  System moved = std::move(system);
  for (int k = 0; k < 500; ++k) {
    const std::string n = std::to_string(k);
    CHECK(&moved.body("body" + n) == bodies[k]);
    CHECK(moved.marker("hinge" + n + ".S").name == "hinge" + n + ".S");
    CHECK(moved.link("hinge" + n).name() == "hinge" + n);
    check_words(message_of<ModelError>([&] { moved.add_fixed("hinge" + n + ".P"); }),
                {"'hinge" + n + ".P'", "taken by a marker"});
  }
  check_words(message_of<ModelError>([&] { moved.body("hinge7"); }), {"hinge7"});  // a link
}

TEST_CASE("a renamed body is found by its name, and its old name is free", "[unit][system]") {
  System system;
  Body& b = system.add_body("crank", kMass);
  b.name = "lever";
  CHECK(&system.body("lever") == &b);
  check_words(message_of<ModelError>([&] { system.body("crank"); }), {"crank"});
  Body& other = system.add_body("crank", kMass);
  CHECK(&system.body("crank") == &other);
}

TEST_CASE("constraint blocks of equal joints are stored once, others separately", "[unit][system]") {
  System system;
  Body &a = system.add_body("a", kMass), &b = system.add_body("b", kMass);
  Lock& first = system.add<Revolute>("first", a, system.ground(), pose_at(Vec3::Zero()));
  Lock& second = system.add<Revolute>("second", b, system.ground(), pose_at(Vec3::Zero()));
  Lock& other = system.add<Prismatic>("other", b, a, pose_at(Vec3::Zero()));
  system.setup();
  CHECK(&first.row(0) == &second.row(0));
  CHECK(&first.row(0) != &other.row(0));
  CHECK(other.row_name(4) == "e3");
  system.changed();
  system.setup();
  CHECK(&first.row(0) == &second.row(0));
}

TEST_CASE("unknown names are rejected with the nearest", "[unit][system]") {
  System system;
  Body& b = system.add_body("crank", kMass);
  system.add<Revolute>("hinge", b, system.ground(), pose_at(Vec3::Zero()));
  CHECK(says(message_of<ModelError>([&] { system.body("crnk"); }), {"unknown body \"crnk\"", "\"crank\""}));
  CHECK(says(message_of<ModelError>([&] { system.link("hing"); }), {"unknown joint \"hing\"", "\"hinge\""}));
  CHECK(says(message_of<ModelError>([&] { system.marker("hinge.Q"); }), {"unknown marker", "hinge."}));
  CHECK(says(message_of<ModelError>([&] { system.force("wind"); }), {"unknown force \"wind\""}));
  CHECK(&system.body("crank") == &b);
  CHECK(system.link("hinge").name() == "hinge");
  CHECK(system.marker("hinge.P").body == &b);
}

TEST_CASE("impossible poses are rejected", "[unit][system]") {
  System system;
  const auto refused = [&](const Pose& pose) {
    return message_of<ModelError>([&] { system.add_body("b", kMass, pose); });
  };
  CHECK(says(refused({Vec3(0, std::nan(""), 0), {}}), {"body 'b'", "not finite"}));
  CHECK(says(refused({Vec3::Zero(), {2, 0, 0, 0}}), {"body 'b'", "length 2", "normalise"}));
  CHECK(says(refused({Vec3::Zero(), {0, 0, 0, 0}}), {"body 'b'", "length 0"}));
  CHECK(says(message_of<ModelError>([&] { system.add_particle("p", -1, Vec3::Zero()); }),
             {"'p'", "-1 kg", "above zero"}));
  CHECK(says(message_of<ModelError>([] { pose_at(Vec3::Zero(), Vec3(0, 0, 0)); }), {"zero", "give a direction"}));
}

TEST_CASE("at puts z along its argument, right-handed", "[unit][system]") {
  for (const Vec3& z : {Vec3(0, 0, 1), Vec3(0, 0, -2), Vec3(1, 0, 0), Vec3(-3, 1e-9, 0), Vec3(0.3, -0.5, 0.1)}) {
    const Pose p = pose_at(Vec3(1, 2, 3), z);
    CHECK((rotation(p.q).col(2) - z.normalized()).norm() < 1e-14);
    CHECK(p.x == Vec3(1, 2, 3));
    CHECK(std::abs(norm2(p.q) - 1) < 1e-14);
  }
  CHECK((rotation(pose_at(Vec3::Zero(), Vec3(0, 0, 5)).q) - Mat3::Identity()).norm() < 1e-14);
}

TEST_CASE("setup counts rigid groups and unknowns, and does so once", "[unit][system]") {
  System system;
  Body& a = system.add_body("a", kMass, {Vec3(1, 0, 0), axis_angle(Vec3(1, 1, 0), 0.6)});
  Body& wall = system.add_fixed("wall", {Vec3(0, 1, 0), axis_angle(Vec3(0, 0, 1), 0.4)});
  Body& bead = system.add_particle("bead", 1.0, Vec3(0, 0, 2));
  Marker& P = system.add_marker("P", a);
  Marker& S = system.add_marker("S", wall);
  Counting& link = system.add<Counting>("link", P, S);
  CHECK_FALSE(system.ready());
  system.setup();
  CHECK(system.ready());
  CHECK(system.n_slots() == 2);
  CHECK(system.n_velocities() == 9);
  CHECK(a.slot == 0);
  CHECK(bead.slot == 1);
  CHECK(wall.slot == kGround);
  CHECK(link.number() == 0);
  system.setup();
  CHECK(link.n_setups == 1);
  system.add_body("late", kMass);
  CHECK_FALSE(system.ready());
  system.setup();
  CHECK(link.n_setups == 2);
  CHECK(system.n_slots() == 3);

  // a slot stands at the mass centre, with the body's axes; the body's own frame comes back
  a.start = {Vec3(0.1, 0.2, 0.3), Vec3(1, -1, 2)};
  const State state = system.start();
  const Mat3 A = oracle::paper::rotation(a.home.q.coefficients());
  CHECK((state.slot_pose(a.slot).x - (a.home.x + A * kMass.center)).norm() < 1e-15);
  CHECK((state.slot_twist(a.slot).v - (a.start.v + A * oracle::paper::skew(a.start.w) * kMass.center)).norm() < 1e-15);
  CHECK((body_pose(a, state).x - a.home.x).norm() < 1e-15);
  CHECK((body_twist(a, state).v - a.start.v).norm() < 1e-15);
  CHECK(body_pose(wall, state).x == wall.home.x);
  CHECK(body_twist(wall, state).v == Vec3::Zero());
}

TEST_CASE("the length of a system is its longest arm, radius of gyration or span of a link", "[unit][system]") {
  System system;
  system.add_marker("wall", system.ground(), pose_at(Vec3(100, 0, 0)));
  Body& a = system.add_body("a", kMass);
  system.setup();
  const double gyration = std::sqrt(kMass.J.trace() / (2 * kMass.mass));
  CHECK(std::abs(system.length() - gyration) < 1e-15);
  system.add_marker("near", a, pose_at(kMass.center + Vec3(0, 0.5, 0)));
  system.add_marker("far", a, pose_at(kMass.center + Vec3(3, 4, 0)));
  system.setup();
  CHECK(std::abs(system.length() - 5) < 1e-14);
}

TEST_CASE("a system of very small bodies has their length, wherever it stands", "[unit][system]") {
  const double at = GENERATE(0.0, 10.0);
  System system;
  Body& rod = system.add_body("rod", shapes::rod(1, {at, 0, 0}, {at + 1e-6, 0, 0}));
  system.add<Revolute>("hinge", rod, system.ground(), pose_at(Vec3(at, 0, 0)));
  system.setup();
  CHECK(std::abs(system.length() - 0.5e-6) < 1e-9);
}

TEST_CASE("links of one kind are gathered by one call", "[unit][system]") {
  System system;
  Body& a = system.add_body("a", kMass);
  Body& b = system.add_body("b", kMass);
  auto marker = [&, n = 0](Body& body) mutable -> Marker& {
    return system.add_marker("m" + std::to_string(n++), body);
  };
  system.add<Counting>("l0", marker(a), marker(b));
  system.add<OtherCounting>("l1", marker(a), marker(b));  // another type
  system.add<Counting>("l2", marker(b), marker(a));
  system.add<Counting>("l3", marker(a), marker(b), 7u);            // another pattern
  system.add<Counting>("l4", marker(a), marker(system.ground()));  // fewer slots
  system.add<Counting>("l5", marker(a), marker(b));
  system.setup();
  RowTable table;
  std::vector<Motion> motions;
  State state = system.start();
  const auto gather = [&] {
    passes::lay_out(system, state.modes, table);
    passes::motions(system, state, motions);
    Inputs in;
    in.motions = motions;
    Counting::n_calls = 0, Counting::most_lanes = 0;
    passes::gather_rows(system, in, table);
  };
  gather();
  CHECK(Counting::n_calls == 4);
  CHECK(Counting::most_lanes == 3);
  CHECK(table.n_rows == 6);
  // every link wrote its own row
  for (int k = 0; k < 6; ++k) {
    const RowEntry& e = table.entries[table.entry_of_link[k]];
    CHECK(e.link == k);
    CHECK(table.block(e).C(0) == k);
    CHECK(passes::row_name(system, table, e.first_row) == "constraint row of joint 'l" + std::to_string(k) + "'");
  }

  // the middle one of a group out of force: its row goes, and the group is gathered in two pieces
  state.modes[2] = false;
  gather();
  CHECK(table.n_rows == 5);
  CHECK(table.entry_of_link[2] == -1);
  CHECK(Counting::n_calls == 5);
  CHECK(Counting::most_lanes == 1);
  for (const RowEntry& e : table.entries) CHECK(table.block(e).C(0) == e.link);
  state.modes.assign(6, false);
  gather();
  CHECK(table.n_rows == 0);
  CHECK(Counting::n_calls == 0);
}

TEST_CASE("a joint that starts inactive has no constraints", "[unit][system]") {
  System system;
  Body& a = system.add_body("a", kMass);
  system.add<Revolute>("hinge", a, system.ground(), pose_at(Vec3::Zero())).set_active_at_start(false);
  system.add<Spherical>("ball", a, system.ground(), pose_at(Vec3::Zero()));
  system.setup();
  State state = system.start();
  CHECK(state.modes == std::vector<bool>{false, true});
  CHECK(gathered(system, state).C.size() == 3);
  state.modes[0] = true;
  CHECK(gathered(system, state).C.size() == 8);
}

TEST_CASE("a second gather asks for no memory", "[unit][system]") {
  oracle::Configuration c = oracle::random_configuration(3);
  TwoBodies two(c, 63);
  two.lock(c, Mask::all, 63);
  two.system.add<Revolute>("hinge", *two.body1, two.system.ground(), pose_at(Vec3::Zero()))
      .drive(Axis::rz, std::make_shared<Number>(LawValue{1, 2, 3}));
  two.system.add<Distance>("rod", *two.body2, two.system.ground(), pose_at(Vec3(5, 5, 5)),
                           std::make_shared<Number>(LawValue{1, 2, 3}));
  two.system.set_gravity(Vec3(0, 0, -9.81));
  // the rod's markers stand at one point at home, which it refuses: give it a length by moving one
  two.system.marker("rod.S").local.x += Vec3(1, 0, 0);
  two.system.setup();
  const State state = two.system.start();
  RowTable table;
  std::vector<Motion> motions;
  VecX f(6 * two.system.n_slots());
  const auto gather = [&] {
    passes::lay_out(two.system, state.modes, table);
    passes::motions(two.system, state, motions);
    Inputs in;
    in.motions = motions;
    passes::gather_rows(two.system, in, table);
    passes::gather_forces(two.system, in, f);
  };
  gather();
  const long before = allocations();
  for (int k = 0; k < 10; ++k) gather();
  CHECK(allocations() == before);
  CHECK(f.allFinite());
  CHECK(table.n_rows == 13);
}

TEST_CASE("markers and joints of another system are rejected by name", "[unit][system]") {
  System other;
  Body& stranger = other.add_body("stranger", kMass);
  Marker& theirs = other.add_marker("theirs", stranger);
  Lock& their_hinge = other.add<Revolute>("their hinge", stranger, other.ground(), pose_at(Vec3::Zero()));
  SECTION("in a link") {
    System system;
    system.add_body("own", kMass);
    system.add<Spherical>("ball", theirs, system.add_marker("s", system.ground()));
    const std::string said = message_of<ModelError>([&] { system.setup(); });
    CHECK(says(said, {"joint 'ball'", "marker 'theirs'", "body 'stranger' of another System", "add_marker"}));
  }
  SECTION("in a force") {
    System system;
    system.add_body("own", kMass);
    system.add(std::make_unique<AppliedForce>("push", theirs, AppliedForce::Options{{1, 0, 0}}));
    CHECK(says(message_of<ModelError>([&] { system.setup(); }), {"force 'push'", "marker 'theirs'", "another System"}));
  }
  SECTION("read by friction") {
    System system;
    system.add_body("own", kMass);
    system.add(
        std::make_unique<JointFriction>("friction", their_hinge, JointFriction::Options{.mu = 0.1, .radius = 0.01}));
    CHECK(says(message_of<ModelError>([&] { system.setup(); }), {"force 'friction'", "another System"}));
  }
}

TEST_CASE("a moment on a particle is rejected by name", "[unit][system]") {
  System system;
  Body& bead = system.add_particle("bead", 1, {1, 0, 0});
  Marker& p = system.add_marker("p", bead);
  const bool twists = GENERATE(true, false);
  system.add(function_force("twist", {&p}, [&](const Inputs& in, WrenchSum& out) {
    out.force(bead.slot, {0, 1, 0}, in.slot(bead.slot).x);
    if (twists) out.torque(bead.slot, {0, 0, 0.5});
  }));
  system.setup();
  VecX f = VecX::Zero(6);
  StateInputs inputs;
  const State start = system.start();
  const std::string said = message_of<ModelError>([&] { passes::gather_forces(system, inputs.at(system, start), f); });
  CHECK(says(said, {twists ? "force 'twist'" : "no error"}));
  CHECK(says(said, {twists ? "0.5 N m on body 'bead'" : ""}));
}

TEST_CASE("a start velocity that is no number is rejected by the name of its body", "[unit][system]") {
  for (const bool turns : {false, true})
    for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
      System system;
      Body& body = system.add_body("wheel", kMass);
      (turns ? body.start.w : body.start.v)[1] = bad;
      CHECK(says(message_of<ModelError>([&] { system.setup(); }), {"body 'wheel'", "velocity that is not finite"}));
    }
}

TEST_CASE("a constraint without a gradient at the start is named", "[unit][system]") {
  System system;  // Counting's rows say nothing of their bodies
  Body& body = system.add_body("body", kMass);
  system.add<Counting>("flat", system.add_marker("p", body), system.add_marker("s", system.ground()));
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  State state = system.start();
  const std::string assembled = message_of<AssemblyError>([&] { assemble(dynamics, state); });
  CHECK(says(assembled, {"constraint row of joint 'flat' has no gradient at the start", "start its bodies elsewhere"}));
  StepLoop run(dynamics, std::make_unique<Dopri5>());
  CHECK(message_of<AssemblyError>([&] { run.run_until(1); }) == assembled);
}

}  // namespace system_test
