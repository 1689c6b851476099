// SPDX-License-Identifier: BSD-3-Clause
// Gears, belts, differentials, racks and screws: which way they turn, from any start; their check; what is refused.
#include <lockstep/couplings.h>

#include <functional>
#include <string>
#include <vector>

#include <lockstep/author/check.h>
#include <lockstep/error.h>
#include <lockstep/joints.h>
#include <lockstep/laws.h>
#include "tests/support/catch.h"
#include "tests/support/link_bench.h"
#include "tests/support/messages.h"

namespace gears_test {

using namespace lockstep;
using lockstep::testing::check_words, lockstep::testing::LinkBench, lockstep::testing::message_of;

namespace {

const MassProperties kMass{1.0, Vec3(0.1, 0, 0.05), Mat3::Identity()};

/// Wheels in joints on one carrier, each about its own axis and begun at an angle of its own.
struct Wheels {
  System system;
  Body& carrier = system.add_body("carrier", kMass, {Vec3(0.3, 0, 0.1), axis_angle(Vec3(1, 2, 0), 0.6)});
  std::vector<Body*> bodies;
  std::vector<const Lock*> joints;
  std::vector<Vec3> axes;

  void wheel(const Vec3& axis, double angle) {
    const std::string name(1, static_cast<char>('a' + bodies.size()));
    const Pose joint = pose_at(Vec3(0.2 * double(bodies.size()), 0.1, 0), axis);
    axes.push_back(rotation(joint.q).col(2));
    bodies.push_back(&system.add_body(name, kMass, {Vec3(0.1, 0.2, 0), axis_angle(axes.back(), angle)}));
    Marker& p = system.add_marker_at(name + ".p", *bodies.back(), {joint.x, axis_angle(axes.back(), angle) * joint.q});
    Marker& s = system.add_marker_at(name + ".s", carrier, joint);
    joints.push_back(&system.add<Revolute>(name + " joint", p, s));
  }
  /// C of the last link when the wheels have turned by `turns` from their start.
  double C(const std::vector<double>& turns) {
    system.setup();
    State s = system.start();
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const Pose joint = system.marker(std::string(1, static_cast<char>('a' + k)) + ".s").local;
      const Pose world = carrier.home * joint;
      const Pose turned = world * Pose{Vec3::Zero(), axis_angle(Vec3(0, 0, 1), turns[k])} * inverse(world) *
                          s.slot_pose(bodies[k]->slot);
      s.q.segment<3>(7 * bodies[k]->slot) = turned.x, s.q.segment<4>(7 * bodies[k]->slot + 3) = turned.q.coefficients();
    }
    Dynamics dynamics(system, std::make_unique<DenseSolver>());
    const Evaluation& at = dynamics.gather(s);
    double C = HUGE_VAL;
    for (const RowEntry& e : at.rows().entries)
      if (e.m == 1) C = at.rows().block(e).C(0);
    return C;
  }
};

Wheels two() {
  Wheels w;
  w.wheel(Vec3(0, 0, 1), 2.6), w.wheel(Vec3(0.4, 0.3, 1), -2.9);
  return w;
}

}  // namespace

TEST_CASE("Gears and belts rotate in the right direction from any start", "[unit][links]") {
  struct Case {
    const char* name;
    std::function<std::unique_ptr<Lock>(const CoupledPairs&)> make;
    double second;  // turn of wheel 2 when wheel 1 turns by one
  };
  const std::vector<Case> cases = {
      {"external", [](const CoupledPairs& s) { return std::make_unique<Gear>(s, 2.5); }, -1 / 2.5},
      {"internal", [](const CoupledPairs& s) { return std::make_unique<Gear>(s, 2.5, Gear::Mesh::internal); }, 1 / 2.5},
      {"bevel", [](const CoupledPairs& s) { return std::make_unique<Gear>(s, 2.5, Gear::Mesh::bevel); }, -1 / 2.5},
      {"open belt",
       [](const CoupledPairs& s) {
         return std::make_unique<Belt>(s, Belt::Options{0.2, 0.5});
       },
       0.2 / 0.5},
      {"crossed belt",
       [](const CoupledPairs& s) {
         return std::make_unique<Belt>(s, Belt::Options{0.2, 0.5, true});
       },
       -0.2 / 0.5}};
  for (const Case& c : cases) {
    CAPTURE(c.name);
    Wheels w = two();
    Lock& link = w.system.add(c.make(across("link", {*w.joints[0], *w.joints[1]})));
    CHECK(std::abs(w.C({0, 0})) <= 1e-14);
    CHECK(std::abs(w.C({0.7, 0.7 * c.second})) <= 1e-14);
    CHECK(std::abs(w.C({0.7, -0.7 * c.second})) > 0.05);
    CHECK(std::abs(w.C({0.7, 0})) > 0.05);
    CHECK(link.row_name(0) == "teeth");
    CHECK(link.slots().n == 3);
    const CheckReport report = check_lock(w.system, link);
    INFO(report.text());
    CHECK(report.ok());
  }
}

TEST_CASE("A differential distributes a rotation", "[unit][links]") {
  for (const double ratio : {1.0, 2.5}) {
    Wheels w = two();
    w.wheel(Vec3(-0.2, 0.1, 1), 0.4);
    Lock& link =
        w.system.add(std::make_unique<Differential>(across("link", {*w.joints[0], *w.joints[1], *w.joints[2]}), ratio));
    CHECK(std::abs(w.C({0, 0, 0})) <= 1e-14);
    CHECK(std::abs(w.C({0.8, 0.8, 0.8})) <= 1e-14);         // as one
    CHECK(std::abs(w.C({0.8, -0.8 / ratio, 0})) <= 1e-14);  // cage or arm held
    CHECK(std::abs(w.C({0.8, 0, 0.8 / (1 + ratio)})) <= 1e-14);
    CHECK(std::abs(w.C({0.8, 0.8, 0})) > 0.1);
    CHECK(link.slots().n == 4);
    const CheckReport report = check_lock(w.system, link);
    INFO(report.text());
    CHECK(report.ok());
  }
}

TEST_CASE("A pinion rolls along its rack, and a rack slides by its pinion", "[unit][links]") {
  const auto turned = [](double angle) { return axis_angle(Vec3(0, 0, 1), angle); };
  for (const double radius : {0.3, -0.3}) {
    LinkBench bench({Vec3(0.4, 0, 0), turned(1.1)});
    const auto& link = bench.system.add<RollingRack>("rack", bench.p(), bench.s(), radius);
    bench.begin();
    for (int i = 0; i <= 60; ++i) {  // ahead: a pinion above its rack turns backwards about z
      bench.put({Vec3(0.4 + 0.1 * i, 0, 0), turned(1.1 - 0.1 * i / radius)}, 0.1, Vec3(1, 0, 0),
                Vec3(0, 0, -1 / radius));
      CHECK(std::abs(bench.C(4)) <= 1e-14 * 20);
      bench.accept();
    }
    CHECK(link.row_kind(4) == RowKind::translation);
    const CheckReport report = check_lock(bench.system, link);
    INFO(report.text());
    CHECK(report.ok());
  }
  Wheels w = two();
  Marker& p = w.system.add_marker_at("rack.p", w.system.add_body("rack", kMass), pose_at(Vec3(0, 0, 0.3), Vec3(1, 0, 0.2)));
  Marker& s = w.system.add_marker_at("rack.s", w.carrier, pose_at(Vec3(0, 0, 0.1), Vec3(1, 0, 0.2)));
  CoupledPairs pairs = across("link", {*w.joints[0]});
  pairs.pairs.emplace_back(&p, &s);
  Lock& link = w.system.add(std::make_unique<RackAndPinion>(pairs, 0.3));
  CHECK(std::abs(w.C({0, 0})) <= 1e-14);
  CHECK(std::abs(w.C({0.5, 0}) + 0.15) <= 1e-14);  // the rack has yet to follow by radius times turn
  const CheckReport report = check_lock(w.system, link);
  INFO(report.text());
  CHECK(report.ok());
}

TEST_CASE("A screw advances by its lead, and by its offset", "[unit][links]") {
  for (const double lead : {0.1, -0.1, 0.0}) {
    LinkBench bench({Vec3(0, 0, 0.5), axis_angle(Vec3(0, 0, 1), -2.0)});
    const auto& link =
        bench.system.add<Screw>("screw", bench.p(), bench.s(), lead, laws::law([](auto t) { return 0.2 * t * t; }));
    bench.begin();
    for (int i = 1; i <= 20; ++i) {
      const double t = 0.1 * i, angle = 3 * t;
      bench.put({Vec3(0, 0, 0.5 + lead * angle / kTwoPi + 0.2 * t * t), axis_angle(Vec3(0, 0, 1), -2.0 + angle)}, 0.1,
                Vec3::Zero(), Vec3(0, 0, 3));
      CHECK(std::abs(bench.C(4)) <= 1e-14);
      CHECK(std::abs(bench.quantity(link, 0) - (angle - 2.0)) <= 1e-13);
      CHECK(std::abs(bench.quantity(link, 1) - 3) <= 1e-13);
      bench.accept();
    }
    CHECK(link.row_name(4) == "thread");
    CHECK(link.diagnose(1).empty());
  }
  LinkBench bench;
  const auto& link =
      bench.system.add<Screw>("screw", bench.p(), bench.s(), 0.1, laws::law([](auto t) { return log(t - 1.0); }));
  CHECK(link.diagnose(0.5).rfind("the law of its offset gives ", 0) == 0);
  CHECK(link.diagnose(2.5).empty());
}

TEST_CASE("An impossible gear, belt, differential or rack is rejected in words", "[unit][links]") {
  const auto error = [](const std::function<void(const CoupledPairs&)>& make) {
    Wheels w = two();
    w.wheel(Vec3(0, 0, 1), 0);
    return message_of<ModelError>([&] { make(across("link", {*w.joints[0], *w.joints[1], *w.joints[2]})); });
  };
  const auto of_two = [](CoupledPairs s) {
    s.pairs.pop_back();
    return s;
  };
  CHECK(error([](const CoupledPairs& s) { Differential{s}; }) == "no error");
  check_words(error([](const CoupledPairs& s) { Differential(s, 0); }), {"joint 'link'", "ratio is 0", "above zero"});
  check_words(error([&](const CoupledPairs& s) { Differential(of_two(s), 1); }), {"'link'", "pair 3", "add it"});
  check_words(error([&](const CoupledPairs& s) {
                Belt(of_two(s), {0, 0.1});
              }),
              {"joint 'link'", "radius_1 is 0", "above zero"});
  check_words(error([&](const CoupledPairs& s) {
                Belt(of_two(s), {0.1, -2});
              }),
              {"joint 'link'", "radius_2 is -2", "above zero"});
  check_words(error([&](const CoupledPairs& s) { RackAndPinion(of_two(s), 0); }),
              {"joint 'link'", "radius is 0 m", "must not be zero"});
  LinkBench bench;
  check_words(message_of<ModelError>([&] { RollingRack("link", bench.p(), bench.s(), 0); }),
              {"joint 'link'", "radius is 0 m", "must not be zero"});
}

}  // namespace gears_test
