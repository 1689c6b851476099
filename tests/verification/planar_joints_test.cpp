// SPDX-License-Identifier: BSD-3-Clause
// Trees whose joints keep them in a plane: the planar recursion against omega, motions against those in space.
#include <cmath>

#include <lockstep/author/passes.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/tree/tree_recursion.h"
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/random_bodies.h"

namespace planar_joints_test {

using namespace lockstep;
using testing::Draw, testing::largest, testing::Quadratic, testing::random_inertia;

namespace {

// Laws in time that say that they stay in the plane.
class Move final : public TranslationLaw {
 public:
  Move(TranslationValue at0, const Vec3& normal) : at0_(std::move(at0)), normal_(normal) {
    at0_.v -= normal * normal.dot(at0_.v), at0_.a -= normal * normal.dot(at0_.a);
  }
  TranslationValue at(double t) const override {
    return {at0_.x + t * (at0_.v + 0.5 * t * at0_.a), at0_.v + t * at0_.a, at0_.a};
  }
  bool stays_in_plane(const Vec3& n) const override { return are_parallel(n, normal_); }

 private:
  TranslationValue at0_;
  Vec3 normal_;
};
class Turn final : public RotationLaw {
 public:
  Turn(const Vec3& axis, LawValue angle) : axis_(axis), angle_(angle) {}
  RotationValue at(double t) const override {
    const LawValue y = angle_.at(t);
    return {exponential(y.y * axis_), y.yd * axis_, y.ydd * axis_};
  }
  bool turns_about(const Vec3& n) const override { return are_parallel(n, axis_); }

 private:
  Vec3 axis_;
  Quadratic angle_;
};

struct Options {
  int bodies = 12, n = 2;
  bool upright = false,  // homes and markers turned about the normal alone
      laws = false;
};

/// Bodies each on the ground or on an earlier one by joints in the plane: any translations in it, and a hinge or none;
/// markers, homes and mass centres anywhere, P on either side.
System random_tree(std::uint64_t seed, Options o) {
  Draw draw(seed);
  System system({.gravity = draw.vector(10.0)});  // its part along the normal is taken by the joints
  const Vec3 normal = Vec3::Unit(o.n);
  const auto number = [&] { return LawValue{draw.number(-2, 2), draw.number(-2, 2), draw.number(-2, 2)}; };
  const auto about_normal = [&] { return axis_angle(normal, draw.number(-3, 3)); };
  const auto home = [&] { return Pose{draw.vector(1.0), o.upright ? about_normal() : Quat::from(draw.quaternion())}; };
  std::vector<Body*> bodies{&system.ground()};
  for (int k = 0; k < o.bodies; ++k) {
    const std::string name = std::to_string(k);
    Body& body = system.add_body("body" + name, {draw.number(0.5, 2), draw.vector(0.3), random_inertia(draw)}, home());
    Body& on = *bodies[draw.number(0, 0.999) * double(bodies.size())];
    // Markers with one axis, number m, along the normal, in either sense.
    const int m = o.upright ? o.n : static_cast<int>(draw.number(0, 2.999));
    const bool down = draw.number(0, 1) < 0.5;
    Quat axes = m == o.n ? Quat{} : axis_angle(Vec3(Vec3::Unit(3 - m - o.n)), 0.5 * kPi);
    if (down) axes = axis_angle(Vec3(Vec3::Unit((o.n + 1) % 3)), kPi) * axes;
    const auto marker = [&](const char* of, Body& b) -> Marker& {
      return system.add_marker_at(of + name, b, {b.home.x + draw.vector(1.0), about_normal() * axes});
    };
    Marker &a = marker("a", body), &b = marker("b", on);
    Mask mask = row_bit(m) | Mask::e123;
    for (int i = 0; i < 3; ++i)
      if (i != m && draw.number(0, 1) < 0.6) mask = mask | row_bit(i);
    if (draw.number(0, 1) < 0.8) mask = Mask(unsigned(mask) & ~unsigned(row_bit(3 + m)));
    const bool turned = draw.number(0, 1) < 0.5;
    auto& lock = system.add<GenericLock>("link" + name, turned ? b : a, turned ? a : b, mask);
    if (o.laws && draw.number(0, 1) < 0.7) {
      const Vec3 axis = Vec3::Unit(m);
      if (draw.number(0, 1) < 0.7)
        lock.move(std::make_shared<Move>(TranslationValue{draw.vector(1.0), draw.vector(1.0), draw.vector(1.0)}, axis));
      if (draw.number(0, 1) < 0.7) lock.turn(std::make_shared<Turn>(axis, number()));
      for (int i = 0; i < 3; ++i)
        if (!includes(mask, row_bit(i)) && draw.number(0, 1) < 0.3)
          lock.drive(Axis(i), std::make_shared<Quadratic>(number()));
      if (!includes(mask, row_bit(3 + m)) && draw.number(0, 1) < 0.3)
        lock.drive(Axis(3 + m), std::make_shared<Quadratic>(number()));
    }
    if (bodies.size() > 1)
      system.add<SpringDamper>("spring" + name, a, system.marker("a0"),
                               SpringDamper::Options{.stiffness = 30, .damping = 2, .free_length = 0.1});
    bodies.push_back(&body);
  }
  Body& bead = system.add_particle("bead", 0.7, draw.vector(1.0));
  system.add<GenericLock>("guide", system.add_marker("bead_m", bead),
                          system.add_marker_at("rail", system.ground(), {draw.vector(1.0), about_normal()}),
                          row_bit(o.n));
  return system;
}

Dynamics dynamics_of(System& system, Formulation formulation) {
  return Dynamics(system, std::make_unique<SchurSolver>(), {.formulation = formulation, .stabilization = {}});
}

State random_state(Dynamics& dynamics, std::uint64_t seed) {
  Draw draw(seed);
  State state = dynamics.system().start();
  dynamics.to_formulation(state);
  REQUIRE(state.coordinates);
  for (double& x : state.q) x = draw.number(-3, 3);
  for (double& x : state.v) x = draw.number(-2, 2);
  state.t = draw.number(-1, 1);
  return state;
}

/// Accelerations of the slots by differences of sixth order of velocities along the rates, laws included.
VecX differences(const System& system, const State& state, const StateRate& rate) {
  const double h = 1e-3, weight[] = {45.0 / 60, -9.0 / 60, 1.0 / 60};
  VecX a = VecX::Zero(6 * system.n_slots());
  for (int k = 1; k <= 3; ++k)
    for (const double sign : {1.0, -1.0}) {
      State y = state;
      y.t += sign * k * h, y.q += sign * k * h * rate.q, y.v += sign * k * h * rate.v;
      for (int slot = 0; slot < system.n_slots(); ++slot) {
        const Motion O = y.coordinates->motion(y, slot);
        a.segment<3>(6 * slot) += sign * weight[k - 1] / h * O.v;
        a.segment<3>(6 * slot + 3) += sign * weight[k - 1] / h * O.w;
      }
    }
  return a;
}

/// Motions are those that the joints have in space, found one after another.
void check_motions(const System& system, const std::shared_ptr<const JointTree>& tree, const State& state) {
  const auto flat = TreeRecursion::of(tree, system, {});
  std::vector<Motion> a, b(static_cast<std::size_t>(system.n_slots() + 1));
  flat->outward(state, a), tree->motions(state, b);
  for (int slot = 0; slot < system.n_slots(); ++slot) {
    const Motion expected = tree->motion(state, slot);
    for (const Motion* m : {&a[slot + 1], &b[slot + 1]}) {
      CHECK((m->x - expected.x).norm() < 1e-12);
      CHECK((m->A - expected.A).norm() < 1e-13);
      CHECK((m->e.coefficients() - expected.e.coefficients()).norm() < 1e-13);  // and their sign
      CHECK((m->v - expected.v).norm() < 1e-11);
      CHECK((m->w - expected.w).norm() < 1e-11);
    }
  }
}

/// Accelerations of the slots, slot axes, as the recursion in the plane gives them, are those that omega solves for in space.
void check_omega(Dynamics& dynamics, const std::shared_ptr<const JointTree>& tree, const State& state) {
  const System& system = dynamics.system();
  const auto flat = TreeRecursion::of(tree, system, {});
  std::vector<Motion> motions;
  flat->outward(state, motions);
  Inputs in;
  in.t = state.t, in.motions = motions;
  VecX f = VecX::Zero(6 * system.n_slots()), vd, a;
  passes::gather_forces(system, in, f);
  flat->accelerate(motions, f, vd), flat->accelerations(motions, a);
  StateRate rate;
  dynamics.rates(state, rate);
  CHECK(largest(rate.v - vd) == 0);  // the planar recursion is the one that runs
  State slots = state;
  dynamics.to_slots(slots);
  CHECK(dynamics.violation(slots) < 1e-12);
  CHECK(dynamics.violation_v(slots) < 1e-11);
  const VecX& expected = dynamics.evaluate(slots).a;
  CHECK(largest(a - expected) < 1e-10 * largest(expected));
  CHECK(largest(differences(system, state, rate) - expected) < 1e-9 * std::max(1.0, largest(expected)));
  double a2 = 0, al = 0;
  for (int k = 0; k < system.n_slots(); ++k) {
    a2 = std::max(a2, expected.segment<3>(6 * k).norm()), al = std::max(al, expected.segment<3>(6 * k + 3).norm());
  }
  CHECK(rate.largest_a == Approx(a2).epsilon(1e-10));
  CHECK(rate.largest_alpha == Approx(al).epsilon(1e-10));
}

/// A mechanism in a plane by name: joints in it as above, of which some hold one turn alone, spherical ones with axes
/// anywhere, bodies that are free, and supports, which hold nothing in the plane and would close loops in space.
System planar_system(std::uint64_t seed, int n, bool laws) {
  Draw draw(seed), turns(seed + 1000);
  const auto flat = [&](Vec3 a) {
    a[n] = 0;
    return a;
  };
  System system({.gravity = flat(draw.vector(10.0))});
  const Vec3 normal = Vec3::Unit(n);
  const auto number = [&] { return LawValue{draw.number(-2, 2), draw.number(-2, 2), draw.number(-2, 2)}; };
  const auto about_normal = [&] { return axis_angle(normal, draw.number(-3, 3)); };
  std::vector<Body*> bodies{&system.ground()};
  for (int k = 0; k < 12; ++k) {
    const std::string name = std::to_string(k);
    const Mat3 J = Vec3(draw.number(1, 2), draw.number(1, 2), draw.number(1, 2)).asDiagonal();
    Body& body = system.add_body("body" + name, MassProperties{draw.number(0.5, 2), flat(draw.vector(0.3)), J},
                                 Pose{flat(draw.vector(1.0)), about_normal()});
    Body& on = *bodies[draw.number(0, 0.999) * double(bodies.size())];
    bodies.push_back(&body);
    const double kind = draw.number(0, 1);
    const auto marker = [&](const std::string& of, Body& b, const Quat& axes) -> Marker& {
      return system.add_marker_at(of + name, b, {flat(b.home.x + draw.vector(1.0)), axes});
    };
    const bool spherical = kind < 0.3, turned = draw.number(0, 1) < 0.5;
    const Quat flip = axis_angle(Vec3(Vec3::Unit((n + 1) % 3)), draw.number(0, 1) < 0.5 ? kPi : 0.0);
    const auto axes = [&](bool anywhere) { return anywhere ? Quat::from(draw.quaternion()) : about_normal() * flip; };
    Marker &a = marker("a", body, axes(spherical && !turned)), &b = marker("b", on, axes(spherical && turned));  // P's
    if (k > 0)
      system.add<SpringDamper>("spring" + name, a, system.marker("a0"),
                               SpringDamper::Options{.stiffness = 30, .damping = 2, .free_length = 0.1});
    if (kind > 0.85) continue;  // free
    Mask mask = spherical ? Mask::xyz : row_bit(n) | row_bit(3 + (n + 1) % 3) | row_bit(3 + (n + 2) % 3);
    for (int i = 0; i < 3 && !spherical; ++i)
      if (i != n && draw.number(0, 1) < 0.6) mask = mask | row_bit(i);
    if (!spherical && draw.number(0, 1) < 0.3) mask = mask | row_bit(3 + n);
    const bool one_turn = !spherical && turns.number(0, 1) < 0.4;
    if (one_turn) mask = (mask & Mask::xyz) | row_bit(3 + static_cast<int>(turns.number(0, 2.999)));
    auto& lock = system.add<GenericLock>("link" + name, turned ? b : a, turned ? a : b, mask);
    if (kind > 0.6)
      system.add<GenericLock>("support" + name, marker("up", body, flip), marker("down", system.ground(), flip),
                              row_bit(n) | row_bit(3 + (n + 1) % 3) | row_bit(3 + (n + 2) % 3));
    const bool holds = overlaps(mask, row_bit((n + 1) % 3) | row_bit((n + 2) % 3) | row_bit(3 + n));  // in the plane
    if (!laws || spherical || !holds) continue;
    TranslationValue move{flat(draw.vector(1.0)), draw.vector(1.0), draw.vector(1.0)};
    if (draw.number(0, 1) < 0.5) lock.move(std::make_shared<Move>(move, normal));
    if (draw.number(0, 1) < 0.5) lock.turn(std::make_shared<Turn>(normal, number()));
    if (!includes(mask, row_bit(3 + n)) && !one_turn && draw.number(0, 1) < 0.3)
      lock.drive(Axis(3 + n), std::make_shared<Quadratic>(number()));
  }
  system.add_particle("bead", 0.7, flat(draw.vector(1.0)));
  system.set_planar(Plane{n});
  return system;
}

/// What integrated states are given to read: the multipliers, by link.
class Witness final : public Auxiliary {
 public:
  explicit Witness(std::shared_ptr<std::vector<VecX>> lambda) : Auxiliary("witness"), lambda_(std::move(lambda)) {}
  int size() const override { return 1; }
  void rates(const Evaluated& v, std::span<double> sd) const override {
    sd[0] = 0;
    *lambda_ = by_link(v.rows, v.lambda);
  }
  static std::vector<VecX> by_link(const RowTable& rows, const VecX& lambda) {
    std::vector<VecX> all(rows.entry_of_link.size());
    for (const RowEntry& e : rows.entries) all[e.link] = lambda.segment(e.first_row, e.m);
    return all;
  }

 private:
  std::shared_ptr<std::vector<VecX>> lambda_;
};

}  // namespace

TEST_CASE("random trees in a plane move as in space and accelerate as in omega", "[verification][joint]") {
  for (const int n : {0, 1, 2})
    for (const bool upright : {false, true})
      for (const bool laws : {false, true})
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
          CAPTURE(n, upright, laws, seed);
          System system = random_tree(seed, {.n = n, .upright = upright, .laws = laws});
          Dynamics dynamics = dynamics_of(system, Formulation::joint);
          const State state = random_state(dynamics, seed);
          const auto tree = std::static_pointer_cast<const JointTree>(state.coordinates);
          REQUIRE(tree->planar());
          CHECK(tree->planar()->plane() == Plane{n});
          check_motions(system, tree, state);
          check_omega(dynamics, tree, state);
        }
}

TEST_CASE("mechanisms that are planar by name accelerate in joint coordinates as in omega, reactions too",
          "[verification][joint]") {
  for (const int n : {0, 1, 2})
    for (const bool laws : {false, true})
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        CAPTURE(n, laws, seed);
        System system = planar_system(seed, n, laws);
        const auto lambda = std::make_shared<std::vector<VecX>>();
        system.add(std::make_unique<Witness>(lambda));
        Dynamics dynamics = dynamics_of(system, Formulation::joint);
        REQUIRE(dynamics.why_not_joint(system.start().modes) == "");
        const State state = random_state(dynamics, seed);
        const auto tree = std::static_pointer_cast<const JointTree>(state.coordinates);
        REQUIRE(tree->planar());
        check_motions(system, tree, state);
        check_omega(dynamics, tree, state);
        State slots = state;
        dynamics.to_slots(slots);
        const Solution& omega = dynamics.evaluate(slots);
        const std::vector<VecX> expected = Witness::by_link(omega.rows, omega.lambda);
        REQUIRE(lambda->size() == expected.size());
        for (std::size_t l = 0; l < expected.size(); ++l) {
          REQUIRE((*lambda)[l].size() == expected[l].size());
          CHECK(largest((*lambda)[l] - expected[l]) < 1e-10 * (1.0 + largest(omega.lambda)));  // 1 N
        }
        State back = slots;
        dynamics.to_formulation(back, &state);
        CHECK(largest(back.q - state.q) < 1e-11);
        CHECK(largest(back.v - state.v) < 1e-11);
      }
}

TEST_CASE("mechanisms that are planar by name move in joint coordinates as in omega", "[verification][joint]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const auto run = [&](Formulation formulation) {
      System system = planar_system(seed, 2, seed > 2);
      Dynamics dynamics = dynamics_of(system, Formulation::joint);
      State start = random_state(dynamics, seed);
      start.t = 0;
      dynamics.to_slots(start);
      Dynamics own = dynamics_of(system, formulation);
      StepLoop loop(own, std::make_unique<Dop853>(), {.tolerance = {1e-12, 1e-14}});
      loop.set_state(start);
      loop.run_until(0.1);
      State end = loop.state();
      CHECK((end.coordinates != nullptr) == (formulation == Formulation::joint));
      own.to_slots(end);
      return end;
    };
    const State joint = run(Formulation::joint), omega = run(Formulation::omega);
    CHECK(largest(joint.v - omega.v) < 1e-9 * std::max(1.0, largest(omega.v)));
  }
}

TEST_CASE("a tree with one joint, or one law, that leaves the plane is no planar one", "[verification][joint]") {
  const auto is_planar = [](const std::function<void(System&, Body&, Body&)>& add) {
    System system;
    Body& a = system.add_body("a", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
    Body& b = system.add_body("b", {1.0, Vec3::Zero(), Mat3::Identity()}, {{1, 0, 0}, {}});
    system.add<Revolute>("first", a, system.ground(), pose_at(Vec3(0, 0, 0)));
    add(system, a, b);
    Dynamics dynamics = dynamics_of(system, Formulation::joint);
    State state = system.start();
    dynamics.to_formulation(state);
    return static_cast<const JointTree&>(*state.coordinates).planar() != nullptr;
  };
  const Pose there = pose_at(Vec3(0.5, 0, 0));
  CHECK(is_planar([&](System& s, Body& a, Body& b) { s.add<Revolute>("second", b, a, there); }));
  CHECK(is_planar(
      [&](System& s, Body& a, Body& b) { s.add<Prismatic>("second", b, a, pose_at(Vec3(0.5, 0, 0), Vec3(1, 2, 0))); }));
  CHECK_FALSE(is_planar([](System&, Body&, Body&) {}));  // b is free
  for (const double tilt : {1e-10, 2e-9})
    CHECK(is_planar([&](System& s, Body& a, Body& b) {
            s.add<Revolute>("second", b, a, pose_at(Vec3(0.5, 0, 0), Vec3(0, tilt, 1)));
          }) == (tilt < kParallel));
  CHECK_FALSE(is_planar([&](System& s, Body& a, Body& b) { s.add<Cylindrical>("second", b, a, there); }));
  CHECK_FALSE(is_planar([&](System& s, Body& a, Body& b) { s.add<Spherical>("second", b, a, there); }));
  CHECK_FALSE(is_planar([&](System& s, Body& a, Body& b) {
    s.add<Revolute>("second", b, a, there).turn(std::make_shared<Turn>(Vec3(1, 0, 0), LawValue{0.0, 1.0, 0.0}));
  }));
  CHECK_FALSE(is_planar([&](System& s, Body& a, Body& b) {
    s.add<Revolute>("second", b, a, there).move(std::make_shared<Move>(TranslationValue{}, Vec3(1, 0, 0)));
  }));
}

TEST_CASE("a long chain in the plane keeps its energy, and its steps allocate nothing", "[verification][joint]") {
  System system({.gravity = {0, -9.81, 0}});
  Body* last = &system.ground();
  const Mat3 J = Vec3(0.01, 1.0 / 12, 1.0 / 12).asDiagonal();
  for (int i = 0; i < 30; ++i) {
    Body& b = system.add_body("rod" + std::to_string(i), {1.0, Vec3::Zero(), J}, {{i + 0.5, 0, 0}, {}});
    system.add<Revolute>("hinge" + std::to_string(i), b, *last, pose_at(Vec3(i, 0, 0)));
    last = &b;
  }
  Dynamics dynamics = dynamics_of(system, Formulation::automatic);
  StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-10, 1e-12}});
  const auto energy = [&] {
    double sum = 0;
    for (int k = 0; k < system.n_slots(); ++k) {
      const Motion m = slot_motion(loop.state(), k);
      sum += 0.5 * m.v.squaredNorm() + 0.5 * m.w.dot(J * m.w) + 9.81 * m.x[1];
    }
    return sum;
  };
  loop.run_until(0.1);
  REQUIRE(loop.state().coordinates);
  REQUIRE(static_cast<const JointTree&>(*loop.state().coordinates).planar());
  const long before = allocations();
  for (int i = 0; i < 10; ++i) loop.step();
  CHECK(allocations() == before);
  loop.run_until(1.0);
  CHECK(std::abs(energy()) < 1e-7);  // of 441 J that the rods have fallen through
}

}  // namespace planar_joints_test
