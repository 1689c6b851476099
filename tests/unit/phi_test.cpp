// SPDX-License-Identifier: BSD-3-Clause
// Joints and couplings from functions: held against rows written by hand, against differences and against the
// symmetries of the theory; turns counted past full ones; what is refused, and how.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/couplings.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include "framework/mechanism/links/gear_functions.h"
#include "framework/mechanism/links/joint_functions.h"
#include "tests/support/catch.h"
#include "tests/support/hand_joints.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/messages.h"

namespace phi_test {

using namespace lockstep;
using lockstep::inputs::Rows, lockstep::inputs::gathered, lockstep::inputs::difference;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

const MassProperties kMass{1.5, Vec3(0.05, -0.1, 0.02), Vec3(0.5, 0.6, 0.7).asDiagonal()};

/// Four bodies, the last one the ground if it is asked for, each with two markers at random places; z axes within a
/// right angle of each other or so.
struct Bodies {
  System system;
  std::vector<Body*> bodies;
  std::vector<Marker*> m, n;

  explicit Bodies(std::uint64_t seed, int grounded = -1) {
    oracle::Draw draw(seed);
    const auto turn = [&] { return exponential(draw.vector(0.5)); };
    for (int k = 0; k < 4; ++k) {
      const std::string name(1, static_cast<char>('a' + k));
      const Pose home{draw.vector(1.0), turn()};
      bodies.push_back(k == grounded ? &system.add_fixed(name, home) : &system.add_body(name, kMass, home));
      m.push_back(&system.add_marker(name + ".m", *bodies.back(), {draw.vector(0.5), turn()}));
      n.push_back(&system.add_marker(name + ".n", *bodies.back(), {draw.vector(0.5), turn()}));
    }
  }
  /// The start, moved by up to 0.3 m and turned by up to 0.7 rad, in motion.
  State state(std::uint64_t seed) {
    system.setup();
    oracle::Draw draw(seed);
    State s = system.start();
    for (int k = 0; k < system.n_slots(); ++k) {
      const Pose p = s.slot_pose(k);
      s.q.segment<3>(7 * k) = p.x + draw.vector(0.3);
      s.q.segment<4>(7 * k + 3) = (p.q * exponential(draw.vector(0.4))).coefficients();
    }
    for (Eigen::Index i = 0; i < s.v.size(); ++i) s.v[i] = draw.number(-2, 2);
    return s;
  }
};

using Add = std::function<Lock&(Bodies&)>;

struct Twin {
  std::string name;
  Add phi, hand;
  double turn;  // by how much C may differ: a full turn, in its measure
  std::function<double(const Lock&)> home;
};

std::vector<Twin> twins() {
  const auto none = [](const Lock&) { return 0.0; };
  return {{"distance", [](Bodies& b) -> Lock& { return b.system.add<Distance>("l", *b.m[0], *b.m[1], 0.8); },
           [](Bodies& b) -> Lock& {
             auto& l = b.system.add<hand::Distance>("l", *b.m[0], *b.m[1], Mask::none);
             l.length = 0.8;
             return l;
           },
           0, none},
          {"universal", [](Bodies& b) -> Lock& { return b.system.add<Universal>("l", *b.m[0], *b.m[1]); },
           [](Bodies& b) -> Lock& { return b.system.add<hand::Universal>("l", *b.m[0], *b.m[1], Mask::xyz); }, 0, none},
          {"screw", [](Bodies& b) -> Lock& { return b.system.add<Screw>("l", *b.m[0], *b.m[1], 0.3); },
           [](Bodies& b) -> Lock& {
             auto& l = b.system.add<hand::Screw>("l", *b.m[0], *b.m[1], Mask::x | Mask::y | Mask::e1 | Mask::e2);
             l.lead = 0.3;
             return l;
           },
           0.3, [](const Lock& l) { return phi_of<ScrewThread>(static_cast<const Screw&>(l).function()).reference; }},
          {"gear, a body shared",
           [](Bodies& b) -> Lock& {
             return b.system.add(std::make_unique<Gear>(Attachment{"l", {{b.m[0], b.m[1]}, {b.m[2], b.n[1]}}}, 2.0));
           },
           [](Bodies& b) -> Lock& {
             auto l = std::make_unique<hand::Gear>("l", *b.m[0], *b.m[1], *b.m[2], *b.n[1]);
             l->ratio = 2.0;
             return b.system.add(std::move(l));
           },
           kTwoPi, [](const Lock& l) { return phi_of<TurnsOfTwo>(static_cast<const Gear&>(l).function()).reference; }},
          {"gear, four bodies",
           [](Bodies& b) -> Lock& {
             return b.system.add(std::make_unique<Gear>(Attachment{"l", {{b.m[0], b.m[1]}, {b.m[2], b.m[3]}}}, 2.0));
           },
           [](Bodies& b) -> Lock& {
             auto l = std::make_unique<hand::Gear>("l", *b.m[0], *b.m[1], *b.m[2], *b.m[3]);
             l->ratio = 2.0;
             return b.system.add(std::move(l));
           },
           kTwoPi, [](const Lock& l) { return phi_of<TurnsOfTwo>(static_cast<const Gear&>(l).function()).reference; }}};
}

/// K of all slots, and each D zero.
MatX matrix_of(const TangentSum& sum) {
  MatX K = MatX::Zero(6 * sum.n_slots(), 6 * sum.n_slots());
  for (std::size_t p = 0; p < sum.pairs().size(); ++p) {
    CHECK(sum.D(p).isZero(0));
    K.block<6, 6>(6 * sum.pairs()[p].row, 6 * sum.pairs()[p].column) = sum.K(p);
  }
  return K;
}

/// Three pairs, two rows, everything that is read, of several kinds.
struct Tangle {
  static constexpr PhiSpec spec{
      .pairs = 3, .rows = 2, .reads = {Reads::both, Reads::translation, Reads::rotation}, .names = {"one", "two"}};
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& a, const LockCoords<T>& b, const LockCoords<T>& c) const {
    using std::exp, std::sin, std::sqrt;
    return {
        a.x * b.y * c.e1 * c.e2 + exp(0.3 * a.z) * a.e0 * a.e2 - sin(mixed(b)) * c.e3 * c.e0 + 0.4 * a.t * c.e0 * c.e1,
        sqrt(2.0 + a.e3 * a.e1 * c.e2 * c.e0) * b.x + b.z * b.z * a.y * a.t - c.e1 * c.e1};
  }
  template <class T>
  static T mixed(const LockCoords<T>& b) {
    return b.y + 0.5 * b.z;
  }
};
class TangleLink final : public PhiCoupling<Tangle> {
 public:
  using PhiCoupling::PhiCoupling;
  std::string_view type() const override { return "tangle"; }
};

/// Three functions of one pair beside a mask.
struct Several {
  static constexpr PhiSpec spec{.rows = 3};
  template <class T>
  std::array<T, 3> operator()(const LockCoords<T>& y) const {
    return {y.e1 * y.e2, y.x * y.e3 * y.e3 - 0.2 * y.t * y.t, y.y * y.y + y.e0 * y.e0 * y.z};
  }
};
class SeveralLink final : public PhiLock<Several> {
 public:
  SeveralLink(std::string name, Marker& p, Marker& s) : PhiLock(std::move(name), p, s, Mask::z | Mask::e1, Several{}) {}
  std::string_view type() const override { return "several"; }
};

/// What a nut or a gear turns: about z by `angle`, `z` along it.
void set(State& s, int slot, double angle, double z, double speed, double lift) {
  s.q.segment<7>(7 * slot) << 0, 0, z, std::cos(angle / 2), 0, 0, std::sin(angle / 2);
  s.v.segment<6>(6 * slot) << 0, 0, lift, 0, 0, speed;
}

}  // namespace

TEST_CASE("Joints from functions have the constraints that were written by hand", "[unit][phi]") {
  for (const Twin& twin : twins())
    for (std::uint64_t seed = 1; seed <= 8; ++seed)
      for (const int grounded : {-1, 0, 1}) {
        CAPTURE(twin.name, seed, grounded);
        Bodies one(seed, grounded), two(seed, grounded);
        const Lock& link = twin.phi(one);
        twin.hand(two);
        const State s1 = one.state(seed + 100), s2 = two.state(seed + 100);
        Rows a = gathered(one.system, s1);
        const Rows b = gathered(two.system, s2);
        const Eigen::Index last = a.C.size() - 1;
        a.C[last] += twin.home(link);
        if (twin.turn > 0) a.C[last] = b.C[last] + std::remainder(a.C[last] - b.C[last], twin.turn);
        CHECK(difference(a.C, b.C) <= 1e-12);
        CHECK(difference(a.Ct, b.Ct) <= 1e-12);
        CHECK(difference(a.Qhat, b.Qhat) <= 1e-12);
        CHECK(difference(a.J, b.J) <= 1e-12);
        CHECK(a.J.row(last).norm() > 0.01);
      }
}

TEST_CASE("Functions of several pairs and several equations pass the check of joints", "[unit][phi]") {
  for (const int grounded : {-1, 0, 1, 3}) {
    CAPTURE(grounded);
    Bodies b(7, grounded);
    const Lock& all = b.system.add(std::make_unique<TangleLink>(
        Attachment{"all", {{b.m[0], b.m[1]}, {b.n[1], b.n[2]}, {b.m[2], b.m[3]}}}, Tangle{}));
    const Lock& common = b.system.add(std::make_unique<TangleLink>(
        Attachment{"common", {{b.m[0], b.m[3]}, {b.m[1], b.n[3]}, {b.n[1], b.n[3]}}}, Tangle{}));
    const Lock& several = b.system.add<SeveralLink>("several", *b.m[0], *b.m[2]);
    for (const Lock* link : {&all, &common, &several}) {
      const CheckReport report = check_lock(b.system, *link);
      INFO(report.text());
      CHECK(report.ok());
      CHECK(report.comparisons() > 500);
    }
    CHECK(all.row_name(1) == "two");
    CHECK(several.row_name(4) == "phi3");
    CHECK(several.row_name(0) == "z");
    CHECK(several.row_kind(0) == RowKind::translation);
    CHECK(several.row_kind(4) == RowKind::function);
    CHECK(several.row_count() == 5);
  }
}

TEST_CASE("The tangent of a function joint is that of its constraints", "[unit][phi]") {
  std::vector<Add> links;
  for (const Twin& twin : twins()) links.push_back(twin.phi);
  links.push_back([](Bodies& b) -> Lock& {
    return b.system.add(std::make_unique<TangleLink>(
        Attachment{"l", {{b.m[0], b.m[1]}, {b.n[1], b.n[2]}, {b.m[2], b.m[3]}}}, Tangle{}));
  });
  links.push_back([](Bodies& b) -> Lock& { return b.system.add<SeveralLink>("l", *b.m[0], *b.m[2]); });
  for (const Add& add : links)
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Bodies b(seed, seed == 3 ? 1 : -1);
      const Lock& link = add(b);
      CAPTURE(link.type(), seed);
      const State state = b.state(seed + 50);
      Dynamics dynamics(b.system, std::make_unique<DenseSolver>());
      const Evaluation& here = dynamics.gather(state);
      oracle::Draw draw(seed + 9);
      VecX lambda(link.row_count());
      for (double& l : lambda) l = draw.number(-2, 2);
      const std::span<const double> given(lambda.data(), lambda.size());
      TangentSum exact, differences;
      exact.lay_out(b.system.n_slots()), differences.lay_out(b.system.n_slots());
      add_tangent(link, here.inputs(), given, exact);
      difference_tangent(link, here.inputs(), given, differences);
      MatX K = matrix_of(exact);
      const double size = K.cwiseAbs().maxCoeff();
      CHECK(size > 0.01);
      CHECK((K - matrix_of(differences)).cwiseAbs().maxCoeff() <= 1e-8 * std::max(1.0, size));
      // (9.4) K less the half moments is symmetric, exactly
      const VecX F = gathered(b.system, state).J.transpose() * lambda;
      for (int k = 0; k < b.system.n_slots(); ++k)
        K.block<3, 3>(6 * k + 3, 6 * k + 3) -= 0.5 * skew(Vec3(F.segment<3>(6 * k + 3)));
      CHECK((K - K.transpose()).cwiseAbs().maxCoeff() <= 1e-13 * std::max(1.0, size));
    }
}

TEST_CASE("A screw counts its revolutions, in steps beyond half a revolution as well, and a rewound step counts once",
          "[unit][phi]") {
  System system;
  Body& nut = system.add_body("nut", MassProperties{1.0, Vec3::Zero(), Mat3::Identity()});
  const double lead = 0.02, speed = 50;
  Screw& screw = system.add<Screw>("screw", nut, system.ground(), pose_at(Vec3::Zero()), lead);
  system.setup();
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  State s = system.start();
  double angle = 0;
  const auto turn_on = [&](State& state, double by, double dt) {
    state.t += dt;
    angle += by, state.s[system.counted_angles().front()->first()] += by;  // as an integrator has it
    set(state, nut.slot, angle, lead / kTwoPi * angle, by / dt, lead / kTwoPi * by / dt);
    const Evaluation& here = dynamics.gather(state);
    CHECK(std::abs(here.rows().block(here.rows().entries.front()).C(4)) <= 1e-13);
    CHECK(std::abs(screw.quantity(0, here.inputs()) - angle) <= 1e-11);
    CHECK(std::abs(screw.quantity(1, here.inputs()) - by / dt) <= 1e-10);
  };
  for (int i = 0; i < 40; ++i) turn_on(s, 0.5, 0.01), dynamics.accept(s);         // 20 rad at 50/s
  for (int i = 0; i < 60; ++i) turn_on(s, 0.1 * speed, 0.1), dynamics.accept(s);  // 5 rad a step
  CHECK(angle > 50 * kTwoPi);
  for (int i = 0; i < 5; ++i) {  // a step goes ahead, is accepted and then undone, again and again
    const State before = s;
    const double angle_before = angle;
    for (int k = 0; k < 7; ++k) turn_on(s, 5.0, 0.1), dynamics.accept(s);
    s = before, angle = angle_before;
    turn_on(s, 2.0, 0.04);
    s = before, angle = angle_before;
  }
  turn_on(s, 5.0, 0.1), dynamics.accept(s);
  for (int i = 0; i < 700; ++i) turn_on(s, angle > 0 ? -0.5 : 0.0, 0.01), dynamics.accept(s);  // and back
  CHECK(std::abs(angle) < 0.6);
}

TEST_CASE("A gear counts the revolutions of both wheels on a rotating carrier", "[unit][phi]") {
  System system;
  const MassProperties mass{1.0, Vec3::Zero(), Mat3::Identity()};
  Body& carrier = system.add_body("carrier", mass);
  Body& one = system.add_body("one", mass, {Vec3::Zero(), axis_angle(Vec3(0, 0, 1), 2.5)});
  Body& two = system.add_body("two", mass, {Vec3::Zero(), axis_angle(Vec3(0, 0, 1), -3.0)});
  auto& a = system.add<Revolute>("a", one, carrier, pose_at(Vec3::Zero()));
  auto& b = system.add<Revolute>("b", two, carrier, pose_at(Vec3::Zero()));
  auto& gear = system.add(std::make_unique<Gear>(across("mesh", {a, b}), 3.0));
  system.setup();
  CHECK(gear.slots().n == 3);
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  State s = system.start();
  for (int i = 1; i <= 400; ++i) {
    const double turn = 0.6 * i, arm = -0.37 * i, dt = 0.05;  // gear 2 on the carrier; carrier in the world
    s.t += dt;
    set(s, carrier.slot, arm, 0, -0.37 / dt, 0);
    set(s, one.slot, arm - 3 * turn + 2.5, 0, (-0.37 - 1.8) / dt, 0);
    set(s, two.slot, arm + turn - 3.0, 0, (-0.37 + 0.6) / dt, 0);
    const Evaluation& here = dynamics.gather(s);
    const RowTable& rows = here.rows();
    for (const RowEntry& e : rows.entries)
      for (int k = 0; k < e.m; ++k) CHECK(std::abs(rows.block(e).C(k)) <= 1e-11);
    dynamics.accept(s);
  }
}

namespace {

/// Turns about z of one pair that tells its rotation alone, and where another is that tells its translation alone.
template <bool rotation_first>
struct Winch {
  static constexpr Reads kFirst = rotation_first ? Reads::rotation : Reads::translation,
                         kSecond = rotation_first ? Reads::translation : Reads::rotation;
  static constexpr PhiSpec spec{.pairs = 2, .reads = {kFirst, kSecond}, .counts_turns = true};
  template <class T>
  T operator()(const LockCoords<T>& a, const LockCoords<T>& b) const {
    if constexpr (rotation_first)
      return b.z - 0.1 * a.angle_z();
    else
      return a.z - 0.1 * b.angle_z();
  }
};
template <bool rotation_first>
class WinchLink final : public PhiCoupling<Winch<rotation_first>> {
 public:
  using PhiCoupling<Winch<rotation_first>>::PhiCoupling;
  std::string_view type() const override { return "winch"; }
};

/// A drum that turns a load up, through many turns: the largest |C| on the way, and the state at its end.
template <bool rotation_first>
State wound(double& worst) {
  System system;
  const MassProperties mass{1.0, Vec3::Zero(), Mat3::Identity()};
  Body &drum = system.add_body("drum", mass), &load = system.add_body("load", mass);
  using MarkerPair = std::pair<Marker*, Marker*>;
  const MarkerPair turning{&system.add_marker("d", drum), &system.add_marker("g", system.ground())},
      rising{&system.add_marker("l", load), &system.add_marker("h", system.ground())};
  system.add(std::make_unique<WinchLink<rotation_first>>(
      Attachment{"winch", rotation_first ? std::vector{turning, rising} : std::vector{rising, turning}},
      Winch<rotation_first>{}));
  system.setup();
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  State s = system.start();
  worst = 0;
  for (int i = 1; i <= 100; ++i) {
    const double angle = 1.3 * i, dt = 0.1;
    s.t += dt;
    set(s, drum.slot, angle, 0, 1.3 / dt, 0);
    set(s, load.slot, 0, 0.1 * angle, 0, 0.13 / dt);
    const Evaluation& here = dynamics.gather(s);
    const double c = std::abs(here.rows().block(here.rows().entries.front()).C(0));
    worst = c <= worst ? worst : c;
    dynamics.accept(s);
  }
  return s;
}

}  // namespace

TEST_CASE("Revolutions are counted of a pair whose translation is not read, before or after one whose rotation is not",
          "[unit][phi]") {
  double first = 0, last = 0;
  const State a = wound<true>(first), b = wound<false>(last);
  CHECK(first <= 1e-11);
  CHECK(last <= 1e-11);
  for (const State* s : {&a, &b}) {
    CHECK(s->q.allFinite());
    CHECK(s->v.allFinite());
    REQUIRE(s->s.size() == CountedAngle::kStates);
    CHECK(s->s.allFinite());
    CHECK(s->s[0] + kTwoPi * s->s[1] == Approx(130.0).epsilon(1e-12));
  }
}

TEST_CASE("Impossible arguments of a function are rejected in words", "[unit][phi]") {
  const auto error = [](const std::function<void(Bodies&)>& act) {
    Bodies b(3);
    return message_of<ModelError>([&] { act(b), b.system.setup(); });
  };
  const Pose over{Vec3::Zero(), axis_angle(Vec3(1, 0, 0), kPi)};
  const auto opposed = [&](Bodies& b) {
    Marker& p = b.system.add_marker_at("down", *b.bodies[0], over);
    Marker& s = b.system.add_marker_at("up", *b.bodies[1], Pose{});
    return std::pair<Marker*, Marker*>{&p, &s};
  };
  check_words(error([&](Bodies& b) {
                const auto [p, s] = opposed(b);
                b.system.add<Screw>("spindle", *p, *s, 0.1);
              }),
              {"joint 'spindle'", "'down'", "'up'", "opposed at the start", "rotate one marker by 180 deg"});
  check_words(error([&](Bodies& b) {
                const auto pair = opposed(b);
                b.system.add(std::make_unique<Gear>(Attachment{"mesh", {{b.m[2], b.m[1]}, pair}}, 2.0));
              }),
              {"joint 'mesh'", "'down'", "'up'", "opposed at the start"});
  check_words(error([](Bodies& b) {
                b.system.add(std::make_unique<Gear>(Attachment{"mesh", {{b.m[0], b.m[1]}}}, 2.0));
              }),
              {"'mesh'", "\"p\"", "pair 2", "add it"});
  check_words(error([](Bodies& b) {
                b.system.add(std::make_unique<Gear>(Attachment{"mesh", {{b.m[0], nullptr}}}, 2.0));
              }),
              {"'mesh'", "\"s\"", "add it"});
  check_words(error([](Bodies& b) {
                b.system.add(std::make_unique<Gear>(
                    Attachment{"mesh", {{b.m[0], b.m[1]}, {b.m[2], b.n[1]}, {b.m[3], b.n[1]}}}, 2.0));
              }),
              {"joint 'mesh'", "takes 2 pairs", "3 are given", "remove"});
  check_words(error([](Bodies& b) {
                b.system.add(std::make_unique<Gear>(Attachment{"mesh", {{b.m[0], b.m[1]}, {b.m[2], b.n[2]}}}, 2.0));
              }),
              {"joint 'mesh'", "pair 2", "on body 'c'", "use two bodies"});
  check_words(error([](Bodies& b) {
                Body& e = b.system.add_body("e", kMass);
                Marker& far = b.system.add_marker("far", e);
                b.system.add(std::make_unique<Differential>(
                    Attachment{"split", {{b.m[0], b.m[1]}, {b.m[2], b.m[3]}, {&far, b.n[3]}}}));
              }),
              {"joint 'split'", "couples 5 bodies", "the limit is 4", "common body"});
  check_words(error([](Bodies& b) {
                Body& p = b.system.add_particle("bead", 1.0, Vec3(1, 0, 0));
                b.system.add<Universal>("cross", b.system.add_marker("eye", p), *b.m[1]);
              }),
              {"joint 'cross'", "'bead'", "particle", "inertia"});
  check_words(error([](Bodies& b) {
                Body &f = b.system.add_fixed("f"), &g = b.system.add_fixed("g");
                Marker &p = b.system.add_marker("fp", f), &s = b.system.add_marker("gs", g);
                Marker &q = b.system.add_marker("fq", f), &r = b.system.add_marker("gr", g);
                b.system.add(std::make_unique<Gear>(Attachment{"mesh", {{&p, &s}, {&q, &r}}}, 2.0));
              }),
              {"joint 'mesh'", "none of the bodies", "can move"});
  for (const double ratio : {0.0, -1.0, HUGE_VAL, std::nan("")})
    check_words(error([&](Bodies& b) {
                  b.system.add(std::make_unique<Gear>(Attachment{"mesh", {{b.m[0], b.m[1]}, {b.m[2], b.n[1]}}}, ratio));
                }),
                {"joint 'mesh'", "ratio", "above zero"});
  check_words(error([](Bodies& b) { b.system.add<Screw>("spindle", *b.m[0], *b.m[1], std::nan("")); }),
              {"joint 'spindle'", "lead", "finite"});
}

}  // namespace phi_test
