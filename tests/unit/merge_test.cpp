// SPDX-License-Identifier: BSD-3-Clause
// Bodies bolted together move as one slot: equal motion with fewer unknowns, and what must stay a link stays one.
#include <lockstep/dynamics.h>
#include <lockstep/solvers.h>
#include <lockstep/joints.h>
#include "tests/support/catch.h"

namespace merge_test {

using namespace lockstep;

namespace {

/// A pendulum of two rods bolted at an angle, on a hinge at the origin; both turn with it.
struct Bent {
  System system{{.gravity = Vec3(0.3, -9.81, 0.2)}};
  Body& a = system.add_body("a", {1.0, Vec3(0.1, 0, 0), Vec3(0.02, 0.1, 0.11).asDiagonal()},
                            {Vec3(0.4, 0, 0), axis_angle(Vec3(1, 2, 3), 0.3)});
  Body& b = system.add_body("b", {2.0, Vec3(0, 0.05, 0), Vec3(0.05, 0.06, 0.1).asDiagonal()},
                            {Vec3(1.0, 0.5, 0.1), axis_angle(Vec3(0, 1, -1), 1.1)});
  Spherical& hinge = system.add<Spherical>("hinge", a, system.ground(), pose_at(Vec3(0, 0, 0)));
  Fixed& bolt = system.add<Fixed>("bolt", b, a, pose_at(Vec3(0.8, 0.1, 0)));

  Bent() {
    const Vec3 w(0.7, -0.4, 1.3);  // world
    for (Body* body : {&a, &b}) {
      body->start.v = cross(w, body->home.x);
      body->start.w = rotation(body->home.q).transpose() * w;
    }
  }
};

// Accelerations of both bodies' frames, origin (world) and angular (body axes), whatever the slots are.
struct Accelerations {
  Vec3 aa, ala, ab, alb;
};
Accelerations accelerations(System& system) {
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  const State s = system.start();
  const VecX& a = dynamics.evaluate(s).a;
  const auto origin = [&](const Body& b) {
    const Mat3 A = rotation(s.slot_pose(b.slot).q);
    const Vec3 w = s.slot_twist(b.slot).w, al = a.segment<3>(6 * b.slot + 3), r = b.in_slot.x;
    return Vec3(a.segment<3>(6 * b.slot) + A * (cross(al, r) + cross(w, cross(w, r))));
  };
  const auto angular = [&](const Body& b) {
    return Vec3(rotation(b.in_slot.q).transpose() * a.segment<3>(6 * b.slot + 3));
  };
  const Body &A = system.body("a"), &B = system.body("b");
  return {origin(A), angular(A), origin(B), angular(B)};
}

}  // namespace

TEST_CASE("bolted bodies move as one rigid group, as the joint would have moved them", "[unit][system]") {
  Bent linked, merged;
  merged.system.set_merge(true);
  const Accelerations truth = accelerations(linked.system), found = accelerations(merged.system);
  CHECK(linked.system.n_slots() == 2);
  CHECK(merged.system.n_slots() == 1);
  CHECK(merged.system.n_velocities() == 6);
  CHECK(merged.system.merged(merged.bolt));
  CHECK_FALSE(merged.system.merged(merged.hinge));
  CHECK((truth.aa - found.aa).norm() <= 1e-12 * truth.aa.norm());
  CHECK((truth.ala - found.ala).norm() <= 1e-12 * truth.ala.norm());
  CHECK((truth.ab - found.ab).norm() <= 1e-12 * truth.ab.norm());
  CHECK((truth.alb - found.alb).norm() <= 1e-12 * truth.alb.norm());
}

TEST_CASE("rigid groups keep the whole: mass, places, and poses of their bodies", "[unit][system]") {
  Bent m;
  m.system.set_merge(true);
  m.system.setup();
  const State s = m.system.start();
  CHECK(m.system.slot(0).mass == Approx(3.0));
  for (const Body* body : {&m.a, &m.b}) {
    const Pose p = body_pose(*body, s);
    CHECK((p.x - body->home.x).norm() <= 1e-14);
    CHECK(rotation(p.q).isApprox(rotation(body->home.q), 1e-14));
    const Twist t = body_twist(*body, s);
    CHECK((t.v - body->start.v).norm() <= 1e-14);
    CHECK((t.w - body->start.w).norm() <= 1e-14);
  }
}

TEST_CASE("a bolt to the ground makes ground of the body", "[unit][system]") {
  System system;
  Body& foot = system.add_body("foot", {1.0, Vec3::Zero(), Mat3(Mat3::Identity())}, {Vec3(1, 0, 0), {}});
  Body& arm = system.add_body("arm", {1.0, Vec3::Zero(), Mat3(Mat3::Identity())}, {Vec3(2, 0, 0), {}});
  system.add<Fixed>("bolt", foot, system.ground(), pose_at(Vec3(0, 0, 0)));
  system.add<Revolute>("hinge", arm, foot, pose_at(Vec3(1, 0, 0)));
  system.set_merge(true);
  system.setup();
  CHECK(foot.slot == kGround);
  CHECK(system.n_slots() == 1);
  CHECK((body_pose(foot, system.start()).x - Vec3(1, 0, 0)).norm() == 0);
}

TEST_CASE("joints that cannot be merged remain", "[unit][system]") {
  {
    Bent m;  // its reaction is wanted
    m.system.set_merge(true, {&m.bolt});
    m.system.setup();
    CHECK(m.system.n_slots() == 2);
  }
  {
    Bent m;  // another link works between the two
    m.system.add<Revolute>("parallel", m.b, m.a, pose_at(Vec3(0.8, 0.2, 0)));
    m.system.set_merge(true);
    m.system.setup();
    CHECK(m.system.n_slots() == 2);
  }
  {
    Bent m;  // not in place at the start
    m.system.marker("bolt.P").local.x[0] += 1e-3;
    m.system.set_merge(true);
    m.system.setup();
    CHECK(m.system.n_slots() == 2);
  }
  {
    Bent m;  // in force only later
    m.bolt.set_active_at_start(false);
    m.system.set_merge(true);
    m.system.setup();
    CHECK(m.system.n_slots() == 2);
  }
}

TEST_CASE("bodies bolted to the ground and held there by another joint stay links", "[unit][system]") {
  System system;
  Body& foot = system.add_body("foot", {1.0, Vec3::Zero(), Mat3(Mat3::Identity())}, {Vec3(1, 0, 0), {}});
  Body& base = system.add_fixed("base");
  system.add<Fixed>("bolt", foot, base, pose_at(Vec3(0, 0, 0)));
  system.add<Spherical>("ball", foot, system.ground(), pose_at(Vec3(0, 1, 0)));
  system.set_merge(true);
  CHECK_NOTHROW(system.setup());
  CHECK(system.n_slots() == 1);
}

}  // namespace merge_test
