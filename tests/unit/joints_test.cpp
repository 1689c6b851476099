// SPDX-License-Identifier: BSD-3-Clause
// The named joints: what each holds and what it lets go, its rows and names; joints from a function; what is refused,
// and how.
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/passes.h>
#include <lockstep/author/phi_links.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include "framework/mechanism/links/joint_functions.h"
#include "tests/support/catch.h"
#include "tests/support/dense.h"
#include "tests/support/lock_functions.h"
#include "tests/support/lock_inputs.h"
#include "tests/support/messages.h"

namespace joints_test {

using lockstep::testing::message_of, lockstep::testing::says;

using namespace lockstep;
using namespace lockstep::inputs;

namespace {

const MassProperties kMass{1.0, Vec3::Zero(), Mat3::Identity()};
const Pose kJoint = pose_at(Vec3(0.3, -0.2, 0.9), axis_angle(Vec3(1, -2, 0.5), 1.2));

/// Two bodies, the joint's markers together at kJoint.
struct Pair {
  System system;
  Body* p = &system.add_body("p", kMass, {Vec3(1, 0.5, 0), axis_angle(Vec3(0.3, 1, 0), 0.8)});
  Body* s = &system.add_body("s", kMass, {Vec3(-0.4, 0.1, 0.2), axis_angle(Vec3(1, 0, 1), -0.5)});
};

/// Velocity of both bodies (12) when S is at rest and P moves along (k = 0, 1, 2) or turns about (3, 4, 5) an axis of S
/// through the joint; body axes for w.
VecX relative_motion(const Pair& pair, int k, const Pose& joint = kJoint) {
  const Vec3 n = rotation(joint.q).col(k % 3);
  VecX v = VecX::Zero(12);
  const int at = 6 * pair.p->slot;
  if (k < 3) {
    v.segment<3>(at) = n;
  } else {
    v.segment<3>(at) = oracle::paper::skew(n) * (pair.p->home.x - joint.x);
    v.segment<3>(at + 3) = rotation(pair.p->home.q).transpose() * n;
  }
  return v;
}

/// Both bodies as one, moving or turning about an axis of the world through its origin.
VecX common_motion(const Pair& pair, int k) {
  VecX v = VecX::Zero(12);
  const Vec3 n = Vec3::Unit(k % 3);
  for (const Body* b : {pair.p, pair.s}) {
    v.segment<3>(6 * b->slot) = k < 3 ? n : Vec3(oracle::paper::skew(n) * b->home.x);
    if (k >= 3) v.segment<3>(6 * b->slot + 3) = rotation(b->home.q).transpose() * n;
  }
  return v;
}

struct Expected {
  const char* type;
  std::function<MarkerLock&(Pair&)> add;
  std::vector<int> free;  ///< of x y z rx ry rz of S
  std::vector<std::string> rows;
};

template <class L>
Expected joint(const char* type, std::vector<int> free, std::vector<std::string> rows) {
  CHECK(L::kType == std::string(type));
  const Registry registry = builtin_registry();
  REQUIRE(registry.links.find(type) != nullptr);
  CHECK(!registry.links.find(type)->info.help.empty());
  return {type, [](Pair& pair) -> MarkerLock& { return pair.system.add<L>("joint", *pair.p, *pair.s, kJoint); },
          std::move(free), std::move(rows)};
}

/// The table that the doc comments say in words.
std::vector<Expected> all_joints() {
  constexpr int x = 0, y = 1, z = 2, rx = 3, ry = 4, rz = 5;
  return {joint<Fixed>("fixed", {}, {"x", "y", "z", "e1", "e2", "e3"}),
          joint<PointOnLine>("point_on_line", {z, rx, ry, rz}, {"x", "y"}),
          joint<PointOnPlane>("point_on_plane", {x, y, rx, ry, rz}, {"z"}),
          joint<PlaneOnPlane>("plane_on_plane", {x, y, rz}, {"z", "e1", "e2"}),
          joint<Revolute>("revolute", {rz}, {"x", "y", "z", "e1", "e2"}),
          joint<Cylindrical>("cylindrical", {z, rz}, {"x", "y", "e1", "e2"}),
          joint<AngularAlignment>("angular_alignment", {x, y, z}, {"e1", "e2", "e3"}),
          joint<Oldham>("oldham", {x, y}, {"z", "e1", "e2", "e3"}),
          joint<Prismatic>("prismatic", {z}, {"x", "y", "e1", "e2", "e3"}),
          joint<Rzeppa>("rzeppa", {rx, ry}, {"x", "y", "z", "e3"}),
          joint<Homokinetic>("homokinetic", {x, y, z, rx, ry}, {"e3"}),
          joint<Spherical>("spherical", {rx, ry, rz}, {"x", "y", "z"})};
}

std::string model_error(const std::function<void()>& act) { return message_of<ModelError>(act); }

}  // namespace

TEST_CASE("each joint holds the coordinates of its comment and releases the rest", "[unit][links]") {
  for (const Expected& e : all_joints()) {
    CAPTURE(e.type);
    Pair pair;
    MarkerLock& link = e.add(pair);
    pair.system.setup();
    CHECK(link.type() == e.type);
    REQUIRE(link.row_count() == static_cast<int>(e.rows.size()));
    for (int k = 0; k < link.row_count(); ++k) {
      CHECK(link.row_name(k) == e.rows[k]);
      CHECK(link.row_kind(k) == (e.rows[k].size() == 1 ? RowKind::translation : RowKind::rotation));
      CHECK(link.row(k).drive == -1);
    }
    const Rows rows = gathered(pair.system, pair.system.start());
    CHECK(rows.C.norm() < 1e-14);  // the joint fits where it was put
    CHECK(rows.Ct.norm() == 0);

    // the null space: six motions as one body, and the free ones; dimensions say that there are no others
    const int n_free = static_cast<int>(e.free.size());
    REQUIRE(n_free + link.row_count() == 6);
    CHECK(dense::rank(rows.J, 1e-9) == link.row_count());
    MatX motions(12, 6 + n_free);
    for (int k = 0; k < 6; ++k) motions.col(k) = common_motion(pair, k);
    for (int i = 0; i < n_free; ++i) motions.col(6 + i) = relative_motion(pair, e.free[i]);
    CHECK((rows.J * motions).cwiseAbs().maxCoeff() < 1e-13);
    CHECK(dense::rank(motions, 1e-9) == 6 + n_free);
    for (int k = 0; k < 6; ++k) {
      const bool free = std::find(e.free.begin(), e.free.end(), k) != e.free.end();
      CAPTURE(k);
      CHECK(((rows.J * relative_motion(pair, k)).norm() < 1e-13) == free);
    }
  }
}

TEST_CASE("shafts of a homokinetic joint rotate at equal rates at every bend", "[unit][links]") {
  for (double bend : {0.0, 0.4, -1.1, 2.0, 3.0}) {
    for (bool with_centre : {false, true}) {
      Pair pair;
      // P is bent against S about an axis normal to z: no twist
      const Pose bent{kJoint.x, kJoint.q * axis_angle(Vec3(0.8, -0.6, 0), bend)};
      Marker& P = pair.system.add_marker_at("P", *pair.p, bent);
      Marker& S = pair.system.add_marker_at("S", *pair.s, kJoint);
      if (with_centre)
        pair.system.add<Rzeppa>("joint", P, S);
      else
        pair.system.add<Homokinetic>("joint", P, S);
      pair.system.setup();
      const Rows rows = gathered(pair.system, pair.system.start());
      CAPTURE(bend, with_centre);
      CHECK(rows.C.norm() < 1e-14);
      // each turns about its own shaft through the joint at the same rate
      VecX v = VecX::Zero(12);
      const auto spin = [&](const Body& b, const Vec3& z) {
        v.segment<3>(6 * b.slot) = oracle::paper::skew(z) * (b.home.x - kJoint.x);
        v.segment<3>(6 * b.slot + 3) = rotation(b.home.q).transpose() * z;
      };
      spin(*pair.p, rotation(bent.q).col(2)), spin(*pair.s, rotation(kJoint.q).col(2));
      CHECK((rows.J * v).norm() < 1e-14);
      v.segment<6>(6 * pair.s->slot) *= 1.01;
      CHECK((rows.J * v).norm() > 1e-4);
    }
  }
}

TEST_CASE("a generic lock is its mask in words", "[unit][links]") {
  Pair pair;
  GenericLock& link = pair.system.add<GenericLock>("lock", *pair.p, *pair.s, kJoint, mask_from("z, e1|e2"));
  link.drive(Axis::x, std::make_shared<Number>(LawValue{0, 0, 0}));
  link.drive(Axis::rz, std::make_shared<Number>(LawValue{0, 0, 0}));
  pair.system.setup();
  CHECK(link.type() == "lock");
  CHECK(link.mask() == (Mask::z | Mask::e1 | Mask::e2));
  CHECK(link.rows() == (Mask::x | Mask::z | Mask::e123));
  REQUIRE(link.row_count() == 5);
  // drives are in the order in which they were given; the joint's own rows belong to none
  CHECK(link.n_drives() == 2);
  CHECK(link.row(0).drive == 0);
  CHECK(link.row(1).drive == -1);
  CHECK(link.row(4).drive == 1);
  CHECK(link.drive(0).name == "x");
  CHECK(link.drive(0).unit == "m");
  CHECK(link.drive(1).name == "rz");
  CHECK(link.drive(1).unit == "rad");
}

// ------------------------------------------------------------------------------------------ functions of the coordinates

namespace {

namespace own {
struct ScrewThread {  ///< oracle::Screw
  double pitch;
  LawPtr<MotionLaw> law;
  static constexpr PhiSpec spec{.counts_turns = true};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - pitch / kTwoPi * y.angle_z() - law_at(*law, y.t);
  }
};
struct RackAndPinion {  ///< oracle::Rack
  double radius;
  LawPtr<MotionLaw> law;
  static constexpr PhiSpec spec{.counts_turns = true};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.x + radius * y.angle_z() - law_at(*law, y.t);
  }
};
struct Cross {  ///< oracle::Universal: x_S . y_P
  static constexpr PhiSpec spec{.reads = Reads::rotation};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return 2.0 * (y.e1 * y.e2 - y.e0 * y.e3);
  }
};
}  // namespace own

template <class Phi>
class Test final : public PhiLock<Phi> {
 public:
  using PhiLock<Phi>::PhiLock;
  std::string_view type() const override { return "test"; }
};

/// The phi row of a lock with the marker laws given, against the oracle, in a random state.
template <class OraclePhi, class Add>
double worst_of_function(std::uint64_t seed, unsigned laws, const OraclePhi& phi, Add&& add) {
  const LawValue law{0.8 + 0.01 * double(seed), 0.35, -0.6};
  const oracle::Configuration c = oracle::random_configuration(seed, {laws & 15u});
  TwoBodies two(c, laws & 15u);
  add(two, std::make_shared<Number>(law));
  two.system.setup();
  const Rows rows = gathered(two.system, two.system.start());
  const oracle::FunctionTerms terms = oracle::function_terms(phi, c, Vec3(law.y, law.yd, law.ydd));
  const auto last = rows.C.size() - 1;
  const auto one = [](double a, double b) { return difference(MatX::Constant(1, 1, a), MatX::Constant(1, 1, b)); };
  return std::max({one(rows.C[last], terms.C), one(rows.Ct[last], terms.Ct), one(rows.Qhat[last], terms.Qhat),
                   difference(rows.J.row(last), terms.Jh.transpose())});
}

/// Angles in random states lie anywhere within two turns; the joint counts from within half a turn of zero.
bool within_half_turn(std::uint64_t seed, unsigned laws) {
  const Vec4 r =
      oracle::error_quaternion(oracle::without_imposed_laws(oracle::random_configuration(seed, {laws & 15u})));
  return std::abs(2 * std::atan2(r[3], r[0])) < kPi;
}

}  // namespace

TEST_CASE("a distance is the function of the theory, with a law too", "[unit][links]") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed)
    for (unsigned laws : {0u, 1u, 4u, 8u, 15u}) {
      CAPTURE(seed, laws);
      CHECK(worst_of_function(seed, laws, oracle::Distance1{}, [](TwoBodies& two, LawPtr<MotionLaw> law) {
              two.system.add<Distance>("rod", *two.P, *two.S, law);
            }) < 1e-12);
    }
}

TEST_CASE("a distance lets go everything that keeps it", "[unit][links]") {
  Pair pair;
  const Vec3 d(0.3, -0.4, 1.2);
  Marker& P = pair.system.add_marker_at("P", *pair.p, pose_at(kJoint.x + d));
  Marker& S = pair.system.add_marker_at("S", *pair.s, pose_at(kJoint.x));
  Distance& link = pair.system.add<Distance>("rod", P, S);
  pair.system.setup();
  CHECK(link.type() == "distance");
  CHECK(link.row_count() == 1);
  CHECK(link.row_name(0) == "phi");
  CHECK(link.row_kind(0) == RowKind::translation);
  CHECK(std::abs(phi_of<DistanceFunction>(link.function()).length_at(3.0) - 1.3) < 1e-14);
  const Rows rows = gathered(pair.system, pair.system.start());
  CHECK(rows.C.norm() < 1e-14);
  CHECK(dense::rank(rows.J, 1e-9) == 1);
  for (int k = 0; k < 6; ++k) CHECK((rows.J * common_motion(pair, k)).norm() < 1e-14);
  // seen from S at rest: along the rod it is held at rate 1; across it, and about P, it is free
  const Vec3 n = d.normalized(), across = oracle::paper::skew(n) * Vec3(0, 0, 1);
  VecX v = VecX::Zero(12);
  v.segment<3>(6 * pair.p->slot) = n;
  CHECK(std::abs((rows.J * v)[0] - 1) < 1e-14);
  v.segment<3>(6 * pair.p->slot) = across;
  CHECK((rows.J * v).norm() < 1e-14);
  for (int k = 3; k < 6; ++k) CHECK((rows.J * relative_motion(pair, k, pose_at(kJoint.x + d))).norm() < 1e-13);
}

TEST_CASE("a joint from a function has the constraints of the chain rule", "[unit][links]") {
  int n = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed)
    for (unsigned laws : {0u, 2u, 8u, 15u}) {
      CAPTURE(seed, laws);
      CHECK(worst_of_function(seed, laws, oracle::Universal{}, [](TwoBodies& two, LawPtr<MotionLaw>) {
              two.system.add<Test<own::Cross>>("universal", *two.P, *two.S, Mask::xyz, own::Cross{});
            }) < 1e-12);
      if (!within_half_turn(seed, laws)) continue;
      ++n;
      CHECK(worst_of_function(seed, laws, oracle::Screw{0.25}, [](TwoBodies& two, LawPtr<MotionLaw> law) {
              two.system.add<Test<own::ScrewThread>>("screw", *two.P, *two.S, mask_from("x y e1 e2"),
                                                     own::ScrewThread{0.25, law});
            }) < 1e-12);
      CHECK(worst_of_function(seed, laws, oracle::Rack{0.4}, [](TwoBodies& two, LawPtr<MotionLaw> law) {
              two.system.add<Test<own::RackAndPinion>>("rack", *two.P, *two.S, mask_from("y z e1 e2"),
                                                       own::RackAndPinion{0.4, law});
            }) < 1e-12);
    }
  CHECK(n > 10);
}

TEST_CASE("a universal joint keeps four constraints at every pair of cross angles", "[unit][links]") {
  for (double a : {-1.2, 0.0, 0.7})
    for (double b : {-1.0, 0.3, 1.3}) {
      // x_S and y_P stay normal: S turns by a about its x, P against the cross by b about its y
      Pair pair;
      const Pose tilted{kJoint.x, kJoint.q * axis_angle(Vec3::UnitX(), a) * axis_angle(Vec3::UnitY(), b)};
      Marker& P = pair.system.add_marker_at("P", *pair.p, tilted);
      Marker& S = pair.system.add_marker_at("S", *pair.s, kJoint);
      Test<own::Cross>& link = pair.system.add<Test<own::Cross>>("universal", P, S, Mask::xyz, own::Cross{});
      pair.system.setup();
      const Rows rows = gathered(pair.system, pair.system.start());
      CAPTURE(a, b);
      REQUIRE(link.row_count() == 4);
      CHECK(link.row_name(3) == "phi");
      CHECK(link.row_kind(3) == RowKind::function);
      CHECK(rows.C.norm() < 1e-14);
      CHECK(dense::rank(rows.J, 1e-9) == 4);
      CHECK(std::abs(rows.J.block(3, 6 * pair.p->slot + 3, 1, 3).norm() - 1) < 1e-13);  // (7.5)
    }
}

TEST_CASE("a screw counts its revolutions, a rejected step leaves no trace", "[unit][links]") {
  const double pitch = 0.25, home = 2.6;
  for (double sign : {1.0, -1.0}) {
    CAPTURE(sign);
    System system;
    const Pose start{Vec3(0.3, 0, pitch / kTwoPi * home), axis_angle(Vec3::UnitZ(), home)};
    Body& nut = system.add_body("nut", kMass, start);
    Marker& P = system.add_marker("P", nut);
    Marker& S = system.add_marker("S", system.ground(), pose_at(Vec3(0.3, 0, 0)));
    const auto none = std::make_shared<Number>(LawValue{0, 0, 0});
    system.add<Test<own::ScrewThread>>("screw", P, S, mask_from("x y e1 e2"), own::ScrewThread{pitch, none});
    system.setup();
    State state = system.start();
    REQUIRE(state.s.size() == CountedAngle::kStates);  // the angle, whole turns, the largest correction
    CHECK(std::abs(state.s[0] - home) < 1e-14);
    const auto turned = [&](const State& from, double angle) {
      State s = from;
      s.q << 0.3, 0, pitch / kTwoPi * angle, axis_angle(Vec3::UnitZ(), angle).coefficients();
      return s;
    };
    const auto error = [&](const State& s) { return gathered(system, s).C[4]; };
    const auto accept = [&](State& s) {
      std::vector<Motion> motions;
      passes::motions(system, s, motions);
      Inputs in;
      in.t = s.t, in.motions = motions, in.s = {s.s.data(), static_cast<std::size_t>(s.s.size())};
      passes::accept(system, in, s);
    };
    double angle = home;
    for (int step = 0; step < 40; ++step) {
      CAPTURE(step);
      // a try that goes far, is looked at, and thrown away
      const State tried = turned(state, angle + sign * 3.0);
      CHECK(std::abs(error(tried)) < 1e-14);
      CHECK(tried.s == state.s);
      angle += sign * 0.8;
      state = turned(state, angle);
      CHECK(std::abs(error(state)) < 1e-14);
      accept(state);
      CHECK(std::abs(state.s[0] + kTwoPi * state.s[1] - angle) < 1e-12);
      CHECK(std::abs(error(state)) < 1e-14);
      // the same place with the other sign of the quaternion is the same angle
      State other = state;
      other.q.segment<4>(3) *= -1;
      CHECK(std::abs(error(other)) < 1e-14);
    }
    CHECK(std::abs(angle - home) > 5 * kTwoPi);
    // where it did not count, the nut is off by whole pitches
    State lost = state;
    lost.s[0] = home, lost.s[1] = 0;
    CHECK(std::abs(std::abs(error(lost)) - 5 * pitch) < 1e-12);
  }
}

// -----------------------------------------------------------------------------------------------------------------
// refusals

TEST_CASE("impossible joints are rejected by name, value and next move", "[unit][links]") {
  Pair pair;
  System& system = pair.system;
  const auto law = std::make_shared<Number>(LawValue{0, 0, 0});

  Revolute& hinge = system.add<Revolute>("hinge", *pair.p, *pair.s, kJoint);
  CHECK(says(model_error([&] { hinge.drive(Axis::x, law); }),
             {"'hinge'", "drive on x", "holds this coordinate", "drive a free one (rz)", "z of its marker S"}));
  try {
    hinge.drive(Axis::x, law);
  } catch (const ModelError& error) {
    CHECK(error.thing.label() == "joint 'hinge' (revolute)");
    CHECK(error.problem == "drive on x: the joint holds this coordinate");
  }
  CHECK(says(model_error([&] { hinge.drive(Axis::rz, nullptr); }), {"'hinge'", "rz", "no law", "give it one"}));
  hinge.drive(Axis::rz, law);
  CHECK(says(model_error([&] { hinge.drive(Axis::rz, law); }), {"'hinge'", "rz", "driven already", "one law"}));
  CHECK(says(model_error([&] { hinge.drive_speed(Axis::rz, law); }), {"'hinge'", "rz", "driven already", "one law"}));
  CHECK(hinge.n_states() == 0);  // what was refused left nothing

  Spherical& ball = system.add<Spherical>("ball", *pair.p, *pair.s, kJoint);
  CHECK(says(model_error([&] { ball.drive(Axis::rx, law); }), {"'ball'", "rx", "x y z", "no axis", "revolute"}));
  CHECK(says(model_error([&] { ball.turn(std::make_shared<Rotation>(RotationValue{})); }),
             {"'ball'", "x y z", "e1 e2 e3", "drive"}));
  AngularAlignment& aligned = system.add<AngularAlignment>("aligned", *pair.p, *pair.s, kJoint);
  CHECK(says(model_error([&] { aligned.move(std::make_shared<Translation>(TranslationValue{})); }),
             {"'aligned'", "e1 e2 e3", "x y z", "drive"}));
  CHECK(says(model_error([&] { system.add<Fixed>("self", *pair.p, *pair.p, kJoint); }),
             {"'self'", "both markers", "'p'", "another"}));

  system.setup();
  CHECK(says(model_error([&] { ball.drive(Axis::rx, law); }), {"'ball'", "rx", "set up", "before"}));
  CHECK(says(model_error([&] { ball.move(std::make_shared<Translation>(TranslationValue{})); }),
             {"'ball'", "set up", "before"}));
}

TEST_CASE("rotations of a particle cannot be held", "[unit][links]") {
  const auto refused = [](const std::function<void(System&, Marker&, Marker&)>& add) {
    System system;
    Body& bead = system.add_particle("bead", 1.0, Vec3(1, 0, 0));
    add(system, system.add_marker("P", bead), system.add_marker("S", system.ground()));
    return model_error([&] { system.setup(); });
  };
  CHECK(says(refused([](System& s, Marker& P, Marker& S) { s.add<Revolute>("hinge", P, S); }),
             {"'hinge'", "e1 e2", "'bead'", "particle", "inertia"}));
  CHECK(says(refused([](System& s, Marker& P, Marker& S) { s.add<Homokinetic>("cv", S, P); }),
             {"'cv'", "e3", "'bead'", "particle"}));
  CHECK(says(refused([](System& s, Marker& P, Marker& S) {
               s.add<Test<own::Cross>>("universal", P, S, Mask::xyz, own::Cross{});
             }),
             {"'universal'", "phi", "'bead'", "particle"}));
  CHECK(refused([](System& s, Marker& P, Marker& S) { s.add<Spherical>("ball", P, S); }) == "no error");
  CHECK(refused([](System& s, Marker& P, Marker& S) { s.add<Distance>("rod", P, S); }) == "no error");
}

TEST_CASE("joints that hold nothing, or hold only fixed bodies, are rejected", "[unit][links]") {
  System system;
  Body& wall = system.add_fixed("wall");
  system.add_body("b", kMass);
  system.add<Fixed>("bolt", wall, system.ground(), kJoint);
  CHECK(says(model_error([&] { system.setup(); }), {"'bolt'", "'wall'", "'ground'", "moving body"}));

  Pair pair;
  pair.system.add<GenericLock>("nothing", *pair.p, *pair.s, kJoint, Mask::none);
  CHECK(says(model_error([&] { pair.system.setup(); }), {"'nothing'", "0 constraints", "mask"}));
}

TEST_CASE("a joint names which of its laws is not finite", "[unit][links]") {
  const double nan = std::nan("");
  const auto bad = std::make_shared<Number>(LawValue{1, nan, 0}), good = std::make_shared<Number>(LawValue{1, 0, 0});
  Pair pair;
  Revolute& hinge = pair.system.add<Revolute>("hinge", *pair.p, *pair.s, kJoint);
  hinge.drive(Axis::rz, bad);
  Fixed& bolt = pair.system.add<Fixed>("bolt", *pair.p, *pair.s, kJoint);
  bolt.move(std::make_shared<Translation>(TranslationValue{Vec3(0, nan, 0)}));
  Fixed& weld = pair.system.add<Fixed>("weld", *pair.p, *pair.s, kJoint);
  weld.turn(std::make_shared<Rotation>(RotationValue{{}, Vec3(0, nan, 0)}));
  Fixed& clamp = pair.system.add<Fixed>("clamp", *pair.p, *pair.s, kJoint);
  pair.system.marker("clamp.S").translation_law = std::make_shared<Translation>(TranslationValue{Vec3(nan, 0, 0)});
  Marker& far = pair.system.add_marker("far", *pair.p, pose_at(Vec3(9, 0, 0)));
  Distance& rod = pair.system.add<Distance>("rod", far, pair.system.marker("bolt.S"), good);
  Distance& cord = pair.system.add<Distance>("cord", far, pair.system.marker("bolt.S"), bad);
  pair.system.setup();
  CHECK(says(hinge.diagnose(0), {"drive rz"}));
  CHECK(says(bolt.diagnose(0), {"translation law"}));
  CHECK(says(weld.diagnose(0), {"rotation law"}));
  CHECK(says(clamp.diagnose(0), {"marker 'clamp.S'"}));
  CHECK(rod.diagnose(0).empty());
  CHECK(says(cord.diagnose(0), {"law of its length"}));
}

TEST_CASE("a distance of zero is rejected", "[unit][links]") {
  const auto refused = [](const std::function<void(System&, Body&)>& add) {
    System system;
    Body& b = system.add_body("b", kMass, pose_at(Vec3(1, 0, 0)));
    add(system, b);
    return model_error([&] { system.setup(); });
  };
  for (double length : {0.0, -0.5, std::nan("")})
    CHECK(says(refused([&](System& s, Body& b) {
                 s.add<Distance>("rod", s.add_marker("P", b), s.add_marker("S", s.ground()), length);
               }),
               {"'rod'", "length", "above zero"}));
  CHECK(says(refused([&](System& s, Body& b) {
               s.add<Distance>("rod", s.add_marker("P", b), s.add_marker("S", s.ground(), pose_at(Vec3(1, 0, 0))), 0.5);
             }),
             {"'rod'", "'P'", "'S'", "same point", "move one"}));
}

}  // namespace joints_test
