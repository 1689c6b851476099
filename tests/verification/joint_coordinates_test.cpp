// SPDX-License-Identifier: BSD-3-Clause
// Joint coordinates against the formulation omega at random states of random trees: accelerations, states read off,
// variations; motions of masks with one turn alone. Other runs: joint_runs_test.cpp.
#include <cmath>

#include <lockstep/author/passes.h>
#include <lockstep/author/stepping.h>
#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "tests/support/catch.h"
#include "tests/support/configuration.h"
#include "tests/support/loops.h"
#include "tests/support/random_bodies.h"
#include "tests/support/worst.h"

namespace joint_coordinates_test {

using namespace lockstep;
using loops::joint_dynamics;
using testing::accelerations, testing::Draw, testing::largest, testing::Quadratic, testing::random_inertia,
    testing::random_pose;

namespace {

// One turn alone has no closed form, and stays a row.
bool holds_one_turn(Mask mask) { return count_rows(mask & Mask::e123) == 1; }

// All but those of a turn and nothing else, which are no joints of a tree.
std::vector<Mask> all_masks() {
  std::vector<Mask> all;
  for (unsigned m = 1; m < 64; ++m)
    if (count_rows(Mask(m)) > 1 || !holds_one_turn(Mask(m))) all.push_back(Mask(m));
  return all;
}

/// Coordinates and rows of a tree of locks: what has a closed form is neither.
void check_layout(const System& system) {
  const TreeLayout layout = lay_out_tree(system, system.start().modes, Taken::all);
  REQUIRE(layout.tree);
  int n_v = system.n_velocities(), n_rows = 0;
  for (const auto& link : system.links()) {
    const Mask rows = link->jointed()->rows();
    n_v -= count_rows(rows) - (holds_one_turn(rows) ? 1 : 0), n_rows += holds_one_turn(rows) ? 1 : 0;
  }
  CHECK(layout.tree->n_v() == n_v);
  CHECK(layout.closures.n_rows == n_rows);
}

/// n bodies, each on the ground or on an earlier one by a lock of the mask that `mask` returns for it, P on either.
template <class MaskOf>
System tree(std::uint64_t seed, int n, MaskOf&& mask) {
  Draw draw(seed);
  System system({.gravity = {0.3, -9.81, 1.2}});
  std::vector<Body*> bodies{&system.ground()};
  for (int k = 0; k < n; ++k) {
    const std::string name = std::to_string(k);
    Body& body = system.add_body("body" + name, {draw.number(0.5, 2), draw.vector(0.3), random_inertia(draw)},
                                 random_pose(draw));
    Body& on = *bodies[draw.number(0, 0.999) * double(bodies.size())];
    Marker &a = system.add_marker("a" + name, body, random_pose(draw)),
           &b = system.add_marker("b" + name, on, random_pose(draw));
    const bool turned = draw.number(0, 1) < 0.5;
    system.add<GenericLock>("link" + name, turned ? b : a, turned ? a : b, mask(k));
    bodies.push_back(&body);
  }
  return system;
}

// Laws in time, given by their values at t = 0.
class Move final : public TranslationLaw {
 public:
  explicit Move(TranslationValue at0) : at0_(std::move(at0)) {}
  TranslationValue at(double t) const override {
    return {at0_.x + t * (at0_.v + 0.5 * t * at0_.a), at0_.v + t * at0_.a, at0_.a};
  }

 private:
  TranslationValue at0_;
};
class Turn final : public RotationLaw {  // right to first order in t
 public:
  explicit Turn(RotationValue at0) : at0_(std::move(at0)) {}
  RotationValue at(double t) const override { return {at0_.q * exponential(t * at0_.w), at0_.w + t * at0_.a, at0_.a}; }

 private:
  RotationValue at0_;
};

/// Gives the locks of a system laws: on their rows, and drives on free axes, as the mask has them.
void add_laws(System& system, std::uint64_t seed) {
  Draw draw(seed);
  for (const auto& link : system.links()) {
    auto& lock = dynamic_cast<GenericLock&>(*link);
    const Mask mask = lock.mask();
    const bool drives = draw.number(0, 1) < 0.5;
    const auto number = [&] {
      return std::make_shared<Quadratic>(LawValue{draw.number(-2, 2), draw.number(-2, 2), draw.number(-2, 2)});
    };
    if (overlaps(mask, Mask::xyz))
      lock.move(std::make_shared<Move>(TranslationValue{draw.vector(1.0), draw.vector(1.0), draw.vector(1.0)}));
    if (overlaps(mask, Mask::e123))
      lock.turn(
          std::make_shared<Turn>(RotationValue{Quat::from(draw.quaternion()), draw.vector(1.0), draw.vector(1.0)}));
    if (!drives) continue;
    for (const Axis axis : {Axis::x, Axis::y, Axis::z})
      if (!includes(mask, row_of(axis))) {
        lock.drive(axis, number());
        break;
      }
    for (const Axis axis : {Axis::rx, Axis::ry, Axis::rz})
      if (!includes(mask, row_of(axis)) && includes(mask | row_of(axis), Mask::e123)) lock.drive(axis, number());
  }
}

/// Lets markers move on their bodies, P's, S's or both, origin and axes.
void move_markers(System& system, std::uint64_t seed) {
  Draw draw(50 + seed);
  for (const auto& link : system.links()) {
    const auto [p, s] = link->pairs().front();
    const double which = draw.number(0, 3);
    for (const Marker* m : {which < 2 ? p : nullptr, which > 1 ? s : nullptr}) {
      if (m == nullptr) continue;
      Marker& marker = system.marker(m->name);
      const double what = draw.number(0, 3);
      if (what < 2)
        marker.translation_law =
            std::make_shared<Move>(TranslationValue{draw.vector(1.0), draw.vector(1.0), draw.vector(1.0)});
      if (what > 1)
        marker.rotation_law =
            std::make_shared<Turn>(RotationValue{Quat::from(draw.quaternion()), draw.vector(1.0), draw.vector(1.0)});
    }
  }
}

/// The same with any mask for each body, but no weld.
System random_tree(std::uint64_t seed, int n) {
  const std::vector<Mask> masks = all_masks();
  Draw draw(1000 + seed);
  return tree(seed, n, [&](int) {
    const Mask m = masks[draw.number(0, 0.999) * double(masks.size())];
    return count_rows(m) == 6 ? Mask::xyz : m;
  });
}

/// A random state in joint coordinates, which satisfies every link.
State random_state(Dynamics& dynamics, std::uint64_t seed) {
  Draw draw(seed);
  State state = dynamics.system().start();
  dynamics.to_formulation(state);
  REQUIRE(state.coordinates);
  for (double& x : state.q) x = draw.number(-1.5, 1.5);
  for (double& x : state.v) x = draw.number(-2, 2);
  for (const TreeNode& n : static_cast<const JointTree&>(*state.coordinates).nodes())
    for (int k = 0; n.left != 0 && k < 3; ++k)  // a turn alone: that part of the quaternion is zero
      if (includes(n.lock->jointed()->rows(), row_bit(3 + k))) state.q[n.first_q + n.n_slides + 1 + k] = 0;
  REQUIRE(dynamics.project(state, 0).converged);  // unit quaternions
  return state;
}

/// Accelerations of the slots, world axes, by differences of sixth order in time, laws included.
VecX differences(Dynamics& dynamics, const State& state, const StateRate& rate) {
  const double h = 2e-3, weight[] = {45.0 / 60, -9.0 / 60, 1.0 / 60};
  VecX a = VecX::Zero(6 * dynamics.system().n_slots());
  std::vector<Motion> motions;
  for (int k = 1; k <= 3; ++k)
    for (const double sign : {1.0, -1.0}) {
      State y = state;
      y.t += sign * k * h;
      y.q += sign * k * h * rate.q, y.v += sign * k * h * rate.v;
      passes::motions(dynamics.system(), y, motions);
      for (int slot = 0; slot < dynamics.system().n_slots(); ++slot) {
        const Motion& O = motions[slot + 1];
        a.segment<3>(6 * slot) += sign * weight[k - 1] / h * O.v;
        a.segment<3>(6 * slot + 3) += sign * weight[k - 1] / h * (O.A * O.w);
      }
    }
  return a;
}

/// What integrated states are given to read.
struct Given {
  VecX a, lambda;
  std::vector<int> first_row;  // by number of the link; -1: it has no rows
  long n = 0;                  // how often
};
class Witness final : public Auxiliary {
 public:
  Witness(std::shared_ptr<Given> given, bool of_laws)
      : Auxiliary("witness"), given_(std::move(given)), of_laws_(of_laws) {}
  int size() const override { return 1; }
  bool vanishes_without_laws() const override { return of_laws_; }
  void rates(const Evaluated& v, std::span<double> sd) const override {
    sd[0] = 0;
    given_->a = v.a, given_->lambda = v.lambda, ++given_->n;
    given_->first_row.clear();
    for (const int e : v.rows.entry_of_link) given_->first_row.push_back(e < 0 ? -1 : v.rows.entries[e].first_row);
  }

 private:
  std::shared_ptr<Given> given_;
  bool of_laws_;
};

/// Accelerations and multipliers found along the tree are those that omega solves for. `only_laws`: of links with laws.
void check_given(const Given& given, const Solution& omega, const System& system, bool only_laws) {
  REQUIRE(given.a.size() == omega.a.size());
  CHECK(largest(given.a - omega.a) < 1e-10 * largest(omega.a));
  for (const RowEntry& e : omega.rows.entries) {
    const auto link = static_cast<std::size_t>(e.link);
    const Jointed* joint = system.links()[link]->jointed();
    const int first = given.first_row[link];
    CHECK((first >= 0) == (!only_laws || joint->has_laws()));
    for (int k = 0; first >= 0 && k < e.m; ++k)
      CHECK(std::abs(given.lambda[first + k] - omega.lambda[e.first_row + k]) <
            1e-10 * (1.0 + largest(omega.lambda)));  // 1 N
  }
}

void check_accelerations(System& system, std::uint64_t seed) {
  const auto given = std::make_shared<Given>();
  const bool only_laws = seed % 2 == 0;
  system.add(std::make_unique<Witness>(given, only_laws));
  Dynamics dynamics = joint_dynamics(system);
  REQUIRE(dynamics.why_not_joint(system.start().modes).empty());
  check_layout(system);
  const State state = random_state(dynamics, seed);
  StateRate rate;
  dynamics.rates(state, rate);
  const VecX a = !state.coordinates->followed().empty() ? differences(dynamics, state, rate)
                                                        : accelerations(dynamics, state, rate);
  State slots = state;
  dynamics.to_slots(slots);
  CHECK(dynamics.violation(slots) < 1e-12);
  CHECK(dynamics.violation_v(slots) < 1e-11);
  CHECK(given->n == 1);
  if (!only_laws || !state.coordinates->followed().empty())
    check_given(*given, dynamics.evaluate(slots), system, only_laws);
  else
    CHECK(given->a.size() == 0);  // where there are no laws nothing is solved for it
  const VecX expected = accelerations(dynamics, slots);
  CHECK(largest(a - expected) < 1e-10 * largest(expected));
  double a2 = 0, al2 = 0;
  for (int k = 0; k < system.n_slots(); ++k)
    keep_worst(a2, expected.segment<3>(6 * k).norm()), keep_worst(al2, expected.segment<3>(6 * k + 3).norm());
  CHECK(std::abs(rate.largest_a - a2) <= 1e-10 * std::max(1.0, a2));
  CHECK(std::abs(rate.largest_alpha - al2) <= 1e-10 * std::max(1.0, al2));
}

}  // namespace

TEST_CASE("every mask, alone and in a chain, accelerates as in omega", "[verification][joint]") {
  const std::vector<Mask> masks = all_masks();
  for (std::size_t m = 0; m < masks.size(); ++m)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(to_string(masks[m]), seed);
      if (count_rows(masks[m]) == 6) continue;  // a weld is merged, or holds to the ground
      System one = tree(100 * m + seed, 1, [&](int) { return masks[m]; });
      check_accelerations(one, seed);
      System three = tree(100 * m + seed, 3, [&](int) { return masks[m]; });
      check_accelerations(three, seed);
    }
}

TEST_CASE("random trees accelerate as in omega", "[verification][joint]") {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    System system = random_tree(seed, 12);
    check_accelerations(system, seed);
  }
}

namespace {

/// Alone and in chains, each mask six times, and random trees: after change(system, seed, seed of laws, whether it is one
/// of the later half of its kind).
template <class Change>
void check_all_accelerations(Change&& change) {
  const std::vector<Mask> masks = all_masks();
  for (std::size_t m = 0; m < masks.size(); ++m)
    for (std::uint64_t seed = 1; seed <= 6; ++seed)
      for (const int n : {1, 3}) {
        CAPTURE(to_string(masks[m]), seed, n);
        System system = tree(100 * m + seed, n, [&](int) { return masks[m]; });
        change(system, seed, 7 * seed, seed > 3);
        check_accelerations(system, seed);
      }
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    System system = random_tree(seed, 12);
    change(system, seed, seed, seed > 10);
    check_accelerations(system, seed);
  }
}

}  // namespace

TEST_CASE("laws and drives of the locks: every mask, both ways round, accelerates as in omega",
          "[verification][joint]") {
  check_all_accelerations([](System& system, std::uint64_t, std::uint64_t laws, bool) { add_laws(system, laws); });
}

TEST_CASE("markers that move on their bodies: every mask, both ways round, accelerates as in omega",
          "[verification][joint]") {
  check_all_accelerations([](System& system, std::uint64_t seed, std::uint64_t laws, bool later) {
    if (later) add_laws(system, laws);
    move_markers(system, seed);
  });
}

namespace {

/// Reads the power of laws alone, for which no row of the tree's joints is gathered.
class PowerMeter final : public Auxiliary {
 public:
  explicit PowerMeter(std::shared_ptr<double> power) : Auxiliary("power"), power_(std::move(power)) {}
  int size() const override { return 1; }
  bool vanishes_without_laws() const override { return true; }
  bool reads_law_power_alone() const override { return true; }
  void rates(const Evaluated& v, std::span<double> sd) const override { sd[0] = 0, *power_ = v.law_power; }

 private:
  std::shared_ptr<double> power_;
};

void check_power(System& system, std::uint64_t seed) {
  const auto power = std::make_shared<double>(NAN);
  system.add(std::make_unique<PowerMeter>(power));
  Dynamics dynamics = joint_dynamics(system);
  State state = random_state(dynamics, seed);
  StateRate rate;
  dynamics.rates(state, rate);
  dynamics.to_slots(state);
  const Solution& omega = dynamics.evaluate(state);
  const double expected = power_of_laws(omega.rows, omega.lambda);
  double size = 1;  // W: the powers of single rows, of which the sum may be small
  for (const RowEntry& e : omega.rows.entries)
    for (int k = 0; k < e.m; ++k) size += std::abs(omega.lambda[e.first_row + k] * omega.rows.block(e).Ct(k));
  CHECK(std::abs(*power - expected) < 1e-10 * size);
}

}  // namespace

TEST_CASE("the power of laws by what joints carry is that by the multipliers of omega", "[verification][joint]") {
  for (const Mask mask : all_masks())
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      CAPTURE(to_string(mask), seed);
      System system = tree(100 * static_cast<std::uint64_t>(mask) + seed, 3, [&](int) { return mask; });
      if (seed != 2) add_laws(system, 7 * seed);
      if (seed > 1) move_markers(system, seed);
      check_power(system, seed);
    }
}

TEST_CASE("masks with one rotation alone move as in omega, in both directions", "[verification][joint]") {
  for (const Mask mask : all_masks())
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      if (!holds_one_turn(mask)) continue;
      CAPTURE(to_string(mask), seed);
      System system = tree(100 * static_cast<std::uint64_t>(mask) + seed, 2, [&](int) { return mask; });
      Dynamics joint = joint_dynamics(system);
      State start = random_state(joint, seed);
      joint.to_slots(start);
      const auto end = [&](Dynamics& dynamics) {
        StepLoop loop(dynamics, std::make_unique<Dop853>(), {.tolerance = {1e-12, 1e-14}});
        loop.set_state(start);
        loop.run_until(0.2);
        CHECK((loop.state().coordinates == nullptr) == (dynamics.options().formulation == Formulation::omega));
        State y = loop.state();
        dynamics.to_slots(y);
        return y;
      };
      Dynamics omega(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega, .stabilization = {}});
      const State a = end(joint), b = end(omega);
      CHECK(largest(a.v - b.v) < 1e-9 * std::max(1.0, largest(b.v)));
      for (int k = 0; k < system.n_slots(); ++k) CHECK((a.slot_pose(k).x - b.slot_pose(k).x).norm() < 1e-9);
    }
}

TEST_CASE("a lock of one rotation and nothing else closes a loop, its body is free", "[verification][joint]") {
  for (const Mask mask : {Mask::e1, Mask::e2, Mask::e3}) {
    System system = tree(3, 1, [&](int) { return mask; });
    system.setup();
    check_layout(system);
    CHECK(lay_out_tree(system, system.start().modes, Taken::all).tree->closures().size() == 1);
  }
}

TEST_CASE("bodies without a joint move freely", "[verification][joint]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    System system({.gravity = {0, 0, -9.81}});
    system.add_body("free", MassProperties{1.0, {0.1, 0, 0}, Vec3(1, 2, 2.5).asDiagonal()});
    Body& other =
        system.add_body("other", MassProperties{1.0, {0.1, 0.2, 0}, Vec3(1, 2, 2.5).asDiagonal()}, {{1, 0, 0}, {}});
    system.add<Revolute>("hinge", other, system.body("free"), pose_at(Vec3(0.5, 0, 0), Vec3(1, 1, 0)));
    check_accelerations(system, seed);
  }
}

TEST_CASE("particles that are free or tied to the ground accelerate as in omega, for all axes of their markers",
          "[verification][joint]") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    System system = random_tree(seed, 3);
    for (const Mask mask : {Mask::none, Mask::x, Mask::y | Mask::z, Mask::xyz})
      for (const bool turned : {false, true}) {
        const std::string name = to_string(mask) + (turned ? "_turned" : "");
        Body& bead = system.add_particle("bead" + name, draw.number(0.5, 2), draw.vector(1.0));
        Marker& on_bead = system.add_marker("bead_marker" + name, bead, {Vec3::Zero(), Quat::from(draw.quaternion())});
        system.add<SpringDamper>("spring" + name, on_bead, system.marker("a0"),
                                 SpringDamper::Options{.stiffness = 30, .damping = 2, .free_length = 0.1});
        if (mask == Mask::none || (turned && mask == Mask::xyz)) continue;
        Marker& there = system.add_marker("ground_marker" + name, system.ground(), random_pose(draw));
        system.add<GenericLock>("tie" + name, turned ? there : on_bead, turned ? on_bead : there, mask);
      }
    check_accelerations(system, seed);
  }
}

TEST_CASE("a state read off gives its motions back", "[verification][joint]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    System system = random_tree(seed, 8);
    if (seed > 10) add_laws(system, seed);
    if (seed % 2 == 0) move_markers(system, seed);
    Dynamics dynamics = joint_dynamics(system);
    State state = random_state(dynamics, seed);
    state.q.array() *= 5;  // angles beyond half a turn
    dynamics.project(state);
    State there = state;
    dynamics.to_slots(there);
    dynamics.to_formulation(there, &state);
    CHECK(largest(there.v - state.v) < 1e-11);
    std::vector<Motion> a, b;
    passes::motions(system, state, a), passes::motions(system, there, b);
    for (std::size_t k = 0; k < a.size(); ++k) {
      CHECK((a[k].x - b[k].x).norm() < 1e-11);
      CHECK((a[k].A - b[k].A).norm() < 1e-12);
      CHECK((a[k].w - b[k].w).norm() < 1e-11);
    }
    for (const TreeNode& n : static_cast<const JointTree&>(*state.coordinates).nodes())  // turns are counted on
      if (n.turn == TreeTurn::hinge)
        CHECK(std::abs(there.q[n.first_q + n.n_slides] - state.q[n.first_q + n.n_slides]) < 1e-11);
  }
}

TEST_CASE("variations are the differences of motions", "[verification][joint]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Draw draw(seed);
    System system = random_tree(seed, 6);
    if (seed > 10) add_laws(system, seed);
    if (seed % 2 == 0) move_markers(system, seed);
    Dynamics dynamics = joint_dynamics(system);
    const State state = random_state(dynamics, seed);
    StateRate d = sized_like(state);
    for (double& x : d.q) x = draw.number(-1, 1);
    for (double& x : d.v) x = draw.number(-1, 1);
    std::vector<Motion> at, above, below;
    passes::motions(system, state, at);
    VecX dx, dv;
    state.coordinates->variations(state, at, d, dx, dv);
    const double h = 1e-5;
    State up = state, down = state;
    up.q += h * d.q, up.v += h * d.v, down.q -= h * d.q, down.v -= h * d.v;
    passes::motions(system, up, above), passes::motions(system, down, below);
    for (int k = 0; k < system.n_slots(); ++k) {
      const Motion &a = above[std::size_t(k + 1)], &b = below[std::size_t(k + 1)], &c = at[std::size_t(k + 1)];
      const Mat3 turn = (a.A - b.A) * c.A.transpose() / (2 * h);
      CHECK(((a.x - b.x) / (2 * h) - dx.segment<3>(6 * k)).norm() < 1e-7);
      CHECK((Vec3(turn(2, 1), turn(0, 2), turn(1, 0)) - dx.segment<3>(6 * k + 3)).norm() < 1e-7);
      CHECK(((a.v - b.v) / (2 * h) - dv.segment<3>(6 * k)).norm() < 1e-6);
      CHECK(((a.A * a.w - b.A * b.w) / (2 * h) - dv.segment<3>(6 * k + 3)).norm() < 1e-6);
    }
  }
}

}  // namespace joint_coordinates_test
