// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/recorder.h>

#include <Eigen/LU>
#include <cmath>
#include <map>
#include <set>

#include <lockstep/author/params.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/finding.h>
#include <lockstep/forces.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include <lockstep/solvers.h>
#include "framework/tools/record/quadrature.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"
#include "tests/support/worst.h"

namespace channel_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::message_of;

namespace {

MassProperties some_mass(double mass, const Vec3& center) {
  MassProperties m{mass, center, Mat3::Zero()};
  m.J << 0.05, 0.004, -0.003, 0.004, 0.07, 0.002, -0.003, 0.002, 0.06;
  return m;
}

/// A spatial arm: driven hinge to a fixed frame, ball joint whose marker slides and turns on the arm, spring to the
/// ground.
struct Arm {
  System system{System::Options{{0.3, -9.81, 1.0}}};
  Body* frame = &system.add_fixed("frame", {{0.1, 0.2, -0.1}, axis_angle({1, 2, 1}, 0.4)});
  Body* arm = &system.add_body("arm", some_mass(2, {0.05, 0.1, -0.02}), {{0.3, 0.1, 0.2}, axis_angle({1, -1, 2}, 0.7)});
  Body* tip =
      &system.add_body("tip", some_mass(1.5, {-0.1, 0.03, 0.06}), {{0.6, 0.4, 0.2}, axis_angle({0, 1, 2}, -0.9)});
  Body* pebble = &system.add_particle("pebble", 0.4, {1, 2, 3});
  Revolute* A = nullptr;
  Spherical* B = nullptr;
  std::unique_ptr<Dynamics> dynamics;
  std::map<std::string, Channel> channels;
  State state;
  double begun = 0;

  /// `reversed`: the fixed frame carries P.
  explicit Arm(bool reversed = false) {
    const Pose hinge = pose_at({0.2, 0.1, 0.1}, Vec3(1, 2, 3));
    A = &system.add<Revolute>("A", reversed ? *frame : *arm, reversed ? *arm : *frame, hinge);
    A->drive(Axis::rz, laws::law([](auto t) { return 0.7 * sin(3.0 * t); }));
    B = &system.add<Spherical>("B", *tip, *arm, Pose{{0.5, 0.3, 0.25}, axis_angle({1, 1, 0}, 0.3)});
    system.marker("B.S").translation_law = laws::translation([](auto t) {
      return std::array{0.1 * sin(2.0 * t), 0.05 * t, 0.2 * t * t};
    });
    system.marker("B.S").rotation_law = laws::rotation([](auto t) {
      return QuatT<decltype(t)>{cos(t), 0.0 * t, 0.3 * sin(t), sin(t)};
    });
    Marker& end = system.add_marker("end", *tip, {{0.2, -0.1, 0.3}, axis_angle({1, 0, 0}, 0.5)});
    end.translation_law = laws::translation([](auto t) {
      return std::array{0.3 * cos(t), 0.0 * t, 0.1 * sin(4.0 * t)};
    });
    end.rotation_law = laws::rotation([](auto t) {
      return QuatT<decltype(t)>{cos(0.5 * t), sin(0.5 * t), 0.0 * t, 0.0 * t};
    });
    Marker& base = system.add_marker("base", system.ground(), {{-0.5, 0, 0}, {}});
    Marker& eye = system.add_marker("eye", *tip, {{0.2, -0.1, 0.3}, {}});
    system.add<SpringDamper>("F", eye, base, SpringDamper::Options{40, 3, 0.5, 0, {}});
  }
  void begin(double t) {
    begun = t;
    dynamics = std::make_unique<Dynamics>(system, std::make_unique<DenseSolver>());
    state = system.start();
    state.t = 0;
    state.v.segment<6>(6 * tip->slot) << 0.1, 0.2, -0.3, 1, -2, 0.5;
    dynamics->project(state);
    advance(state, t, 50);
    dynamics->project(state);
  }
  /// n steps of the classical Runge-Kutta method over the time T, backwards too; not projected.
  void advance(State& s, double T, int n) {
    const double h = T / n;
    StateRate k1, k2, k3, k4;
    const auto moved = [&](double c, const StateRate& k) {
      State m = s;
      m.t += c, m.q += c * k.q, m.v += c * k.v, m.s += c * k.s;
      return m;
    };
    for (int i = 0; i < n; ++i) {
      dynamics->rate(s, k1);
      dynamics->rate(moved(h / 2, k1), k2);
      dynamics->rate(moved(h / 2, k2), k3);
      dynamics->rate(moved(h, k3), k4);
      s.t += h;
      s.q += h / 6 * (k1.q + 2 * k2.q + 2 * k3.q + k4.q);
      s.v += h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v);
      s.s += h / 6 * (k1.s + 2 * k2.s + 2 * k3.s + k4.s);
    }
  }
  Channel& channel(const std::string& name) {
    if (const auto found = channels.find(name); found != channels.end()) return found->second;
    Channel& made = channels.emplace(name, make_channel(system, name)).first->second;
    if (dynamics && !system.ready()) begin(begun);  // it adds states
    return made;
  }
  double at_state(const std::string& name, const State& s) {
    const StepReport none;
    return channels.at(name).value(Sample(*dynamics, s, none));
  }
  double value(const std::string& name) {
    channel(name);
    return at_state(name, state);
  }
  Vec3 vector(const std::string& name) { return {value(name + "x"), value(name + "y"), value(name + "z")}; }
  /// Rate of a channel along the motion: five points, error h^4.
  double difference(const std::string& name) {
    const double h = 2e-4;
    channel(name);
    const auto moved = [&](double d) {
      State s = state;
      advance(s, d, 4);
      return at_state(name, s);
    };
    return (8 * (moved(h) - moved(-h)) - (moved(2 * h) - moved(-2 * h))) / (12 * h);
  }
};

/// (8.6) from the multipliers, by another way than the channels: the poses of the markers and the rows' names.
struct Reaction {
  Vec3 f = Vec3::Zero(), tau = Vec3::Zero();  // on body 1 at P, world
};
Reaction by_formula(Arm& a, const MarkerLock& link, const Quat& q_D, bool of_drives) {
  const Evaluated& v = a.dynamics->evaluate(a.state);
  const RowEntry& e = v.rows.entries[v.rows.entry_of_link[link.number()]];
  Vec3 lt = Vec3::Zero(), lr = Vec3::Zero();
  for (int k = 0; k < e.m; ++k) {
    if ((link.row(k).drive >= 0) != of_drives) continue;
    const std::string row = link.row_name(k);
    if (row[0] == 'e')
      lr[row[1] - '1'] = v.lambda[e.first_row + k];
    else
      lt[row[0] - 'x'] = v.lambda[e.first_row + k];
  }
  const auto world = [&](const Marker& m) {
    const TranslationValue x = m.translation_law ? m.translation_law->at(a.state.t) : TranslationValue{};
    const RotationValue q = m.rotation_law ? m.rotation_law->at(a.state.t) : RotationValue{};
    return body_pose(*m.body, a.state) * m.local * Pose{x.x, q.q};
  };
  const Quat qP = world(link.p()).q, qS = world(link.s()).q;
  const Quat err = conjugate(qS * q_D) * qP;
  Reaction r;
  r.f = -(rotation(qS) * lt);
  r.tau = rotation(qP) * Vec3(-0.5 * (err.w * lr - cross(err.vec(), lr)));
  return r;
}

bool near(const Vec3& a, const Vec3& b, double tolerance = 1e-11) {
  INFO("(" << a.transpose() << ") against (" << b.transpose() << ")");
  const bool close = (a - b).norm() <= tolerance * (1 + b.norm());
  CHECK(close);
  return close;
}

}  // namespace

TEST_CASE("reactions agree with the theory's (8.6), drives apart", "[unit][record]") {
  Arm a;
  for (const std::string part : {"A.", "B.", "A.drive.", "A.drive_rz."})
    for (const char* what :
         {"force_on_p_world_", "torque_on_p_world_", "force_on_p_link_", "force_on_s_world_", "torque_on_s_world_"})
      for (const char* axis : {"x", "y", "z"}) a.channel(part + what + axis);
  a.begin(0.4);
  const Quat turned = axis_angle(Vec3::UnitZ(), 0.7 * std::sin(3.0 * a.state.t));
  const Reaction A = by_formula(a, *a.A, turned, false), D = by_formula(a, *a.A, turned, true),
                 B = by_formula(a, *a.B, {}, false);
  REQUIRE(A.f.norm() > 1);
  REQUIRE(D.tau.norm() > 0.1);
  REQUIRE(B.f.norm() > 1);
  near(a.vector("A.force_on_p_world_"), A.f);
  near(a.vector("A.torque_on_p_world_"), A.tau);
  near(a.vector("A.drive.force_on_p_world_"), D.f);
  near(a.vector("A.drive.torque_on_p_world_"), D.tau);
  near(a.vector("A.drive_rz.torque_on_p_world_"), D.tau);
  near(a.vector("B.force_on_p_world_"), B.f);
  near(a.vector("B.torque_on_p_world_"), Vec3::Zero());
  // (8.6) on body 2, reduced to S
  const Vec3 arm = a.vector("B.P.") - a.vector("B.S.");
  near(a.vector("B.force_on_s_world_"), -B.f);
  near(a.vector("B.torque_on_s_world_"), -B.tau - cross(arm, B.f));
  near(a.vector("A.force_on_s_world_"), -A.f);  // s's body is fixed
  near(a.vector("A.torque_on_s_world_"), Vec3(-A.tau - cross(Vec3(a.vector("A.P.") - a.vector("A.S.")), A.f)));
  const Mat3 S = rotation(Quat{a.value("A.S.qw"), a.value("A.S.qx"), a.value("A.S.qy"), a.value("A.S.qz")});
  near(S * a.vector("A.force_on_p_link_"), A.f);
  near(S * a.vector("A.torque_on_p_link_"), A.tau);
}

TEST_CASE("reactions balance the motion of a body (Newton, Euler)", "[unit][record]") {
  Arm a;
  a.begin(0.4);
  // tip: B and the spring hold it; m a = sum of forces. The spring's force from its channel and its line.
  const Vec3 line = (a.vector("eye.") - a.vector("base.")).normalized();
  const Vec3 spring = -a.value("F.force") * line;
  near(1.5 * a.vector("tip.center_a"), Vec3(1.5 * a.system.gravity() + a.vector("B.force_on_p_world_") + spring), 1e-9);
  const Mat3 R = rotation(Quat{a.value("tip.qw"), a.value("tip.qx"), a.value("tip.qy"), a.value("tip.qz")});
  const Vec3 w = a.vector("tip.omega_body_"), al = a.vector("tip.alpha_body_");
  const Mat3& J = a.tip->mass.J;
  const Vec3 c = a.vector("tip.center_");
  near(R * (J * al + cross(w, Vec3(J * w))),
       Vec3(cross(Vec3(a.vector("B.P.") - c), a.vector("B.force_on_p_world_")) + a.vector("B.torque_on_p_world_") +
            cross(Vec3(a.vector("eye.") - c), spring)),
       1e-9);
}

TEST_CASE("a fixed body that carries P feels the same as one that carries S", "[unit][record]") {
  Arm a(true);
  a.begin(0.3);
  const Evaluated& v = a.dynamics->evaluate(a.state);
  REQUIRE(v.lambda.norm() > 1);
  const Vec3 f = a.vector("A.force_on_p_world_"), tau = a.vector("A.torque_on_p_world_");
  REQUIRE(f.norm() > 1);
  near(a.vector("A.force_on_s_world_"), -f);
  near(a.vector("A.torque_on_s_world_"), Vec3(-tau - cross(Vec3(a.vector("A.P.") - a.vector("A.S.")), f)));
  const Quat turned = axis_angle(Vec3::UnitZ(), 0.7 * std::sin(3.0 * a.state.t));
  const Reaction by = by_formula(a, *a.A, turned, false);
  near(f, by.f);
  near(tau, by.tau);
}

TEST_CASE("rates and second rates are those of the channels they belong to", "[unit][record]") {
  Arm a;
  std::vector<std::pair<std::string, std::string>> pairs;
  const auto three = [&](const std::string& y, const std::string& yd, const std::string& after = {}) {
    for (const std::string k : {"x", "y", "z"}) pairs.push_back({y + k + after, yd + k + after});
  };
  for (const std::string o : {"arm.", "tip.", "end.", "B.S.", "pebble."}) {
    three(o, o + "v"), three(o + "v", o + "a");
    if (o != "pebble.") three(o + "omega_world_", o + "alpha_world_");
  }
  three("tip.omega_body_", "tip.alpha_body_"), three("tip.center_", "tip.center_v"),
      three("tip.center_v", "tip.center_a");
  for (const std::string n : {"@B.S", "@arm", "@ground"}) {
    three("end.", "end.v", n), three("end.v", "end.a", n);
    pairs.push_back({"end.distance" + n, "end.distance_d" + n});
  }
  three("B.", "B.v"), three("B.v", "B.a");
  for (const std::string k : {"x", "y", "z"}) {
    pairs.push_back({"B." + k + "_d", "B." + k + "_dd"});
    pairs.push_back({"B.angle_" + k, "B.angle_" + k + "_d"});
    pairs.push_back({"B.angle_" + k + "_d", "B.angle_" + k + "_dd"});
  }
  pairs.push_back({"A.rz", "A.omega_z"});
  pairs.push_back({"A.rz_d", "A.rz_dd"});
  a.begin(0.4);
  double largest = 0;
  for (const auto& [y, yd] : pairs) {
    const double d = a.difference(y), rate = a.value(yd);
    INFO(yd << " = " << rate << ", difference of " << y << " = " << d);
    CHECK(std::abs(d - rate) <= 2e-7 * (1 + std::abs(rate)));
    keep_worst(largest, std::abs(rate));
  }
  CHECK(largest > 10);
}

TEST_CASE("a driven hinge's coordinate is its law", "[unit][record]") {
  Arm a;
  a.begin(0.4);
  const double t = a.state.t;
  CHECK(a.value("A.rz") == Approx(0.7 * std::sin(3 * t)).margin(1e-10));
  CHECK(a.value("A.rz_d") == Approx(2.1 * std::cos(3 * t)).margin(1e-9));
  CHECK(a.value("A.omega_z") == Approx(2.1 * std::cos(3 * t)).margin(1e-9));
  CHECK(a.value("A.rz_dd") == Approx(-6.3 * std::sin(3 * t)).margin(1e-9));
  CHECK(std::abs(a.value("A.C_e1")) < 1e-10);
  CHECK(a.value("A.violation") < 1e-10);
  CHECK(a.value("violation") < 1e-10);
  CHECK(a.channel("A.lambda_x").unit == "N");
  CHECK(a.channel("A.lambda_e1").unit == "N m");
}

TEST_CASE("energies balance: drives, moving markers, springs, dampers", "[unit][record]") {
  Arm a;
  for (const char* name : {"energy.balance", "energy.drives", "energy.dissipated", "F.dissipated", "A.drive.work"})
    a.channel(name);
  a.begin(0);
  const StepReport none;
  a.channel("energy.balance").memory->start(Sample(*a.dynamics, a.state, none));
  const double before = a.value("energy.total");
  a.advance(a.state, 1.0, 2000);
  CHECK(a.value("energy.dissipated") > 0.1);
  CHECK(a.value("F.dissipated") == Approx(a.value("energy.dissipated")).epsilon(1e-12));
  CHECK(std::abs(a.value("energy.drives")) > 0.1);
  CHECK(std::abs(a.value("energy.drives") - a.value("A.drive.work")) > 1e-3);  // the moving marker works too
  CHECK(std::abs(a.value("energy.total") - before) > 0.1);
  CHECK(std::abs(a.value("energy.balance")) < 1e-8);
  CHECK(a.difference("A.drive.work") == Approx(a.value("A.drive.power")).epsilon(1e-6));
  CHECK(a.value("energy.total") == Approx(a.value("energy.kinetic") + a.value("energy.potential")));
}

TEST_CASE("a quadrature is shared by all who ask", "[unit][record]") {
  Arm a;
  make_channel(a.system, "A.drive.work");
  make_channel(a.system, "A.drive.work");
  const Recorder recorder(a.system, {{"W", "A.drive.work"}, "energy.balance", "energy.drives"});
  std::multiset<std::string> names;
  for (const auto& auxiliary : a.system.auxiliaries()) names.insert(auxiliary->name());
  for (const char* name : {"A.drive.work", "energy.drives", "energy.dissipated"}) CHECK(names.count(name) == 1);
  CHECK(std::set<std::string>(names.begin(), names.end()).size() == names.size());
  struct Own final : Auxiliary {
    using Auxiliary::Auxiliary;
    int size() const override { return 1; }
    void rates(const Evaluated&, std::span<double> sd) const override { sd[0] = 0; }
  };
  a.system.add(std::make_unique<Own>("F.dissipated"));
  check_words(message_of<ModelError>([&] { make_channel(a.system, "F.dissipated"); }), {"F.dissipated", "rename"});
}

TEST_CASE("momenta and energy of free bodies", "[unit][record]") {
  System system;
  Body& b = system.add_body("b", some_mass(2, {0.1, 0, 0}), {{1, 2, 3}, axis_angle({1, 1, 1}, 0.8)});
  b.start = {{0.5, -1, 2}, {1, 3, -2}};
  Body& p = system.add_particle("p", 0.5, {0, 1, 0});
  p.start.v = {3, 0, 0};
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  const State s = system.start();
  const StepReport none;
  const auto value = [&](const std::string& name) {
    return make_channel(system, name).value(Sample(dynamics, s, none));
  };
  const auto vector = [&](const std::string& name) {
    return Vec3(value(name + "x"), value(name + "y"), value(name + "z"));
  };
  const Mat3 R = rotation(b.home.q);
  const Vec3 w = b.start.w, c = b.home.x + R * b.mass.center, vc = b.start.v + R * cross(w, b.mass.center);
  near(vector("momentum."), Vec3(2 * vc + 0.5 * p.start.v));
  near(vector("angular_momentum."),
       Vec3(cross(c, Vec3(2 * vc)) + R * (b.mass.J * w) + cross(p.home.x, Vec3(0.5 * p.start.v))));
  CHECK(value("energy.kinetic") == Approx(vc.squaredNorm() + 0.5 * w.dot(b.mass.J * w) + 0.25 * 9));
  near(vector("b.v"), b.start.v);
  near(vector("b.omega_body_"), w);
  near(vector("b.a"), Vec3(R * (cross(Vec3(b.mass.J.inverse() * cross(Vec3(b.mass.J * w), w)), Vec3(-b.mass.center)) +
                                cross(w, cross(w, Vec3(-b.mass.center))))));
  CHECK(value("b.cardan_1") == Approx(to_angles("xyz", b.home.q).value[0]));
  CHECK(value("b.hpb_3") == Approx(to_angles("zxy", b.home.q).value[2]));
}

TEST_CASE("angles continue beyond full revolutions", "[unit][record]") {
  System system;
  Body& wheel = system.add_body("wheel", some_mass(1, Vec3::Zero()));
  Revolute& A = system.add<Revolute>("A", wheel, system.ground(), Pose{});
  A.drive(Axis::rz, laws::ramp(-10));
  Channel body = make_channel(system, "wheel.angle_z"), link = make_channel(system, "A.rz");
  Dynamics dynamics(system, std::make_unique<DenseSolver>());
  State s = system.start();
  const StepReport none;
  for (double t = 0; t < 5; t += 0.9) {  // 1.4 turns a step
    s.t = t;
    s.q.tail<4>() = axis_angle(Vec3::UnitZ(), -10 * t).coefficients();
    s.v.tail<3>() = Vec3(0, 0, -10);
    for (const auto& angle : system.counted_angles())
      if (t > 0) s.s[angle->first()] -= 9;  // as an integrator has it
    dynamics.accept(s);
    const Sample sample(dynamics, s, none);
    CHECK(body.value(sample) == Approx(-10 * t).margin(1e-12));
    CHECK(link.value(sample) == Approx(-10 * t).margin(1e-12));
  }
}

TEST_CASE("a joint that is not active gives no reaction", "[unit][record]") {
  Arm a;
  a.B->set_active_at_start(false);
  a.begin(0.1);
  for (const char* name : {"B.force_on_p_world_", "B.torque_on_p_link_", "B.force_on_s_world_"})
    CHECK(a.vector(name) == Vec3::Zero());
  CHECK(a.value("B.lambda_x") == 0);
  CHECK(a.value("B.C_x") == 0);
  CHECK(a.value("B.violation") == 0);
}

TEST_CASE("every offered channel can be made, occurs once, and gives a number", "[unit][record]") {
  Arm a;
  a.system.setup();
  const std::vector<ChannelHelp> all = channel_help(a.system);
  std::set<std::string> names;
  for (const ChannelHelp& c : all) {
    INFO(c.name);
    CHECK(names.insert(c.name).second);
    CHECK_FALSE(c.help.empty());
    CHECK(a.channel(c.name).unit == c.unit);
  }
  for (const char* name :
       {"arm.x", "end.omega_world_z", "A.drive.torque_on_p_link_z", "A.lambda_e2", "F.length", "momentum.x", "step"})
    CHECK(names.count(name) == 1);
  a.begin(0.2);
  for (const ChannelHelp& c : all) {
    if (c.name == "solver.smallest_pivot" || c.name == "solver.detector")
      continue;  // infinity where nothing is eliminated
    INFO(c.name);
    CHECK(std::isfinite(a.value(c.name)));
  }
}

TEST_CASE("unknown channels are rejected with the closest and all names", "[unit][record]") {
  Arm a;
  const auto refusal = [&](const std::string& name) {
    return message_of<ModelError>([&] { make_channel(a.system, name); });
  };
  check_words(refusal("arm.anglez"),
              {"arm.anglez", "body 'arm'", "did you mean \"angle_z\"? All: lockstep check SCENE --channels --of arm"});
  check_words(refusal("arm.q"), {"body 'arm' has no \"q\"; it has x, y, z, vx, ..."});
  check_words(refusal("A.drive.torque_on_p_link"), {"joint 'A'", "or \"drive.torque_on_p_link_z\"?"});
  check_words(refusal("A.FX"), {"did you mean \"force_on_p_world_x\"?"});
  check_words(refusal("A.force"), {"it has components only; did you mean \"force_on_p_world_x\"?"});
  check_words(refusal("B.drive.work"), {"joint 'B' has no drive; add one"});
  check_words(refusal("arm"), {"this is body 'arm'; add a quantity, such as \"arm.x\""});
  // the words of drives, stops and starts
  check_words(refusal("A.rx"), {"joint 'A' has no \"rx\"; did you mean \"angle_x\"?"});
  check_words(refusal("A.angle_z_d"), {"joint 'A' has no \"angle_z_d\"; did you mean \"rz_d\"?"});
  check_words(refusal("A.reaction_x"), {"did you mean \"force_on_p_world_x\"?"});
  check_words(refusal("arm.ry"), {"body 'arm' has no \"ry\"; did you mean \"angle_y\"?"});
  // names that say more
  check_words(refusal("arm.omega_z"), {"did you mean \"omega_world_z\" or \"omega_body_z\"?"});
  CHECK_FALSE(testing::says(refusal("arm.omega_q"), {"did you mean \"omega_world_z\" or"}));
  check_words(refusal("arn.x"), {"\"arn\"", "did you mean \"arm\"?"});
  check_words(refusal("energy.totl"), {"did you mean \"energy.total\"?"});
  check_words(refusal("nonsense"), {"nonsense", "an object and a quantity"});
  check_words(refusal("end.x@nowhere"), {"nowhere"});
  check_words(refusal("end.distnace@base"), {"'end' seen from 'base'", "did you mean \"distance\"?"});
  check_words(refusal(""), {"object and a quantity"});
  check_words(refusal("."), {"object and a quantity"});
  check_words(refusal("@"), {"channel"});
}

TEST_CASE("a recorder makes a table under the user's names", "[unit][record]") {
  Arm a;
  Recorder recorder(a.system, {"arm.x", {"Bx", "B.force_on_p_world_x"}, "rejected"});
  recorder.add("twice", "s", [](const Sample& s) { return 2 * s.state.t; });
  check_words(message_of<ModelError>([&] { recorder.add("Bx", "", [](const Sample&) { return 0.0; }); }), {"\"Bx\""});
  check_words(message_of<ModelError>([&] { Recorder(a.system, {"arm.x", "arm.x"}); }), {"\"arm.x\""});
  a.begin(0);
  StepReport report;
  recorder.start(Sample(*a.dynamics, a.state, report));
  for (int i = 0; i < 3; ++i) {
    recorder.output(Sample(*a.dynamics, a.state, report));
    a.advance(a.state, 0.1, 20);
    report.rejected = 2;
    recorder.step(Sample(*a.dynamics, a.state, report));
  }
  const Table& table = recorder.table();
  CHECK(table.names() == std::vector<std::string>{"t", "arm.x", "Bx", "rejected", "twice"});
  CHECK(column_title(table.column("Bx")) == "Bx [N]");
  REQUIRE(table.n_rows() == 3);
  CHECK(table.change("t") == Approx(0.2));
  CHECK(table.last("twice") == 2 * table.last("t"));
  CHECK(table["rejected"] == std::vector<double>{0, 2, 4});
  CHECK(table.first("arm.x") == Approx(0.3));
  recorder.start(Sample(*a.dynamics, a.state, report));
  CHECK(recorder.table().n_rows() == 0);
}

}  // namespace channel_test
