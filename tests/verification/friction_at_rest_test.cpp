// SPDX-License-Identifier: BSD-3-Clause
// Friction at rest: whether it holds a start, against closed forms.
#include <cmath>
#include <memory>
#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/equilibrium.h>
#include <lockstep/lockstep.h>
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace friction_at_rest_test {

using namespace lockstep;
using Kind = Stability::Kind;

namespace {

constexpr double kG = 9.81;

MassProperties block(double mass, const Vec3& center = Vec3::Zero()) {
  return {mass, center, (0.01 * mass * Vec3(2, 3, 4)).asDiagonal()};
}
/// Axes with z down a slope in the xz plane, x normal to it and upwards.
Pose down_slope(double alpha, double x = 0) {
  const Vec3 z(std::cos(alpha), 0, -std::sin(alpha));
  return pose_at(x * z, z);
}
JointFriction& rub(System& system, const Lock& link, const JointFriction::Options& options) {
  return static_cast<JointFriction&>(
      system.add(std::make_unique<JointFriction>(link.name() + ".friction", link, options)));
}
EquilibriumReport rest(System& system, const EquilibriumOptions& options = {}) {
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  State state = system.start();
  return find_equilibrium(dynamics, state, options);
}

}  // namespace

TEST_CASE("friction holds a block on a slope up to tan(alpha) = mu, and its load is reported",
          "[verification][statics][friction]") {
  for (const double mu : {0.1, 0.5, 1.2})
    for (const bool guided : {true, false})
      for (const double slope : {0.3 * mu, mu * (1 - 1e-5), mu * (1 + 1e-5), 2 * mu}) {
        CAPTURE(mu, guided, slope);
        const double alpha = std::atan(slope), mass = 3;
        System system({.gravity = {0, 0, -kG}});
        Body& body = system.add_body("block", block(mass));
        const Pose at = down_slope(alpha);
        // A guide, or a plane on which it may slide and turn: that is a plane's normal, z, against x of the slope's axes.
        const Lock& link =
            guided
                ? static_cast<Lock&>(system.add<Prismatic>("guide", body, system.ground(), at))
                : static_cast<Lock&>(system.add<Oldham>("guide", body, system.ground(),
                                                        pose_at({0, 0, 0}, Vec3(std::sin(alpha), 0, std::cos(alpha)))));
        rub(system, link, {.mu = mu});
        if (slope > mu) {
          const std::string said = testing::message_of<SolveError>([&] { rest(system, {.relaxation_steps = 100}); });
          CHECK(said.find("friction does not hold the start: 'guide.friction' (sliding) needs ") !=
                std::string::npos);
          continue;
        }
        const EquilibriumReport found = rest(system);
        CHECK(found.stability.kind == Kind::gripped);
        CHECK(found.by_friction);
        CHECK(found.largest_move == 0);
        CHECK(found.notes.empty());
        REQUIRE(found.grips.size() == 1);
        CHECK(found.grips.front().force == "guide.friction");
        CHECK(found.grips.front().what == "sliding");
        CHECK(found.grips.front().unit == "N");
        CHECK(found.grips.front().carries == Approx(mass * kG * std::sin(alpha)).epsilon(1e-9));
        CHECK(found.grips.front().most == Approx(mu * mass * kG * std::cos(alpha)).epsilon(1e-6));
      }
}

TEST_CASE("friction at rest has the coefficient of rest, the preload and the shape of its bearing",
          "[verification][statics][friction]") {
  // A pendulum on a bearing of radius r: it rests where its mass centre is beside the axis by mu_s r at most.
  const double r = 0.05, mu = 0.2, mu_s = 0.4, mass = 2;
  for (const double beside : {0.5 * mu_s * r, 0.999 * mu_s * r, 1.001 * mu_s * r}) {
    CAPTURE(beside);
    System system({.gravity = {0, -kG, 0}});
    Body& body = system.add_body("wheel", block(mass, {beside, -0.3, 0}));
    const Lock& hinge = system.add<Revolute>("bearing", body, system.ground(), pose_at({0, 0, 0}));
    rub(system, hinge, {.mu = mu, .mu_static = mu_s, .radius = r});
    const EquilibriumReport found = rest(system);
    CHECK((found.stability.kind == Kind::gripped) == (beside < mu_s * r));
    CHECK(found.by_friction == (beside < mu_s * r));
    REQUIRE(found.grips.size() == 1);
    CHECK(found.grips.front().unit == "N m");
    CHECK(found.grips.front().carries == Approx(mass * kG * beside).epsilon(1e-9));
    CHECK(found.grips.front().most == Approx(mu_s * r * mass * kG).epsilon(1e-6));
    if (beside < mu_s * r) continue;
    CHECK(found.stability.kind == Kind::stable);  // where it hangs
    CHECK(found.largest_move > 0);
    REQUIRE(found.notes.size() == 2);
    CHECK(found.notes.front().text().find("friction does not hold the start") != std::string::npos);
  }
  // Without friction nothing is said of it, nor of friction where nothing is free to move.
  for (const bool driven : {false, true}) {
    System system({.gravity = {0, -kG, 0}});
    Body& body = system.add_body("wheel", block(mass, {0.1, -0.3, 0}));
    Revolute& hinge = system.add<Revolute>("bearing", body, system.ground(), pose_at({0, 0, 0}));
    if (driven) hinge.drive(Axis::rz, laws::constant(0));
    rub(system, hinge, {.mu = driven ? mu : 0, .radius = r});
    CHECK(rest(system).notes.empty());
  }
  // Level, under a push that only a preload resists.
  for (const double push : {4.9, 5.1}) {
    System system;
    Body& body = system.add_body("block", block(mass));
    const Lock& guide = system.add<Prismatic>("guide", body, system.ground(), pose_at({0, 0, 0}, Vec3::UnitX()));
    rub(system, guide, {.mu = 0.5, .preload = 10});
    system.add(std::make_unique<AppliedForce>("push", system.add_marker_at("at", body, pose_at({0, 0, 0})),
                                              AppliedForce::Options{.force = Vec3(push, 0, 0)}));
    if (push < 5)
      CHECK(rest(system).stability.kind == Kind::gripped);
    else
      testing::check_words(testing::message_of<SolveError>([&] { rest(system, {.relaxation_steps = 100}); }),
                           {"'guide.friction' (sliding) needs 5.1 N (limit 5)"});
  }
}

// A footstep bearing: a disc on a vertical axis rests on a collar of radius r_a and leans against a journal of radius r. Its
// weight is the axial load, a push P through the axis the radial one: a torque turns it beyond mu_s (r P + r_a m g).
TEST_CASE("the limit of a bearing counts its axial load at the friction radius", "[verification][statics][friction]") {
  const double mu = 0.1, mu_s = 0.15, mass = 4;
  struct Bearing {
    double r, r_a, push;
  };
  for (const Bearing& b : {Bearing{0.02, 0.05, 0}, Bearing{0.02, 0.05, 30}, Bearing{0, 0.05, 30}, Bearing{0.02, 0, 30}})
    for (const double share : {0.999, 1.001}) {
      CAPTURE(b.r, b.r_a, b.push, share);
      const double most = mu_s * (b.r * b.push + b.r_a * mass * kG);
      System system({.gravity = {0, 0, -kG}});
      Body& disc = system.add_body("disc", block(mass));
      const Lock& bearing = system.add<Revolute>("bearing", disc, system.ground(), pose_at({0, 0, 0}));
      rub(system, bearing, {.mu = mu, .mu_static = mu_s, .radius = b.r, .axial_radius = b.r_a, .load_smoothing = 1e-9});
      system.add(std::make_unique<AppliedForce>("load", system.add_marker_at("at", disc, pose_at({0, 0, 0})),
                                                AppliedForce::Options{.force = Vec3(0.6 * b.push, -0.8 * b.push, 0)}));
      system.add(std::make_unique<AppliedTorque>("turn", system.marker("at"),
                                                 AppliedTorque::Options{.torque = Vec3(0, 0, share * most)}));
      if (share > 1) {
        testing::check_words(testing::message_of<SolveError>([&] { rest(system, {.relaxation_steps = 100}); }),
                             {"'bearing.friction' (turning) needs "});
        continue;
      }
      const EquilibriumReport found = rest(system);
      CHECK(found.stability.kind == Kind::gripped);
      REQUIRE(found.grips.size() == 1);
      CHECK(found.grips.front().what == "turning");
      CHECK(found.grips.front().unit == "N m");
      CHECK(found.grips.front().carries == Approx(share * most).epsilon(1e-9));
      CHECK(found.grips.front().most == Approx(most).epsilon(1e-8));
    }
}

// A load on an arm presses a clamp to its column by a moment, which friction turns into a grip: any load holds beyond the
// arm b/mu, and none within it.
TEST_CASE("a clamp jams on its column beyond the arm b/mu, for every load", "[verification][statics][friction]") {
  const double mu = 0.25, b = 0.1;
  for (const double mass : {0.01, 1.0, 1e4})
    for (const double arm : {0.99 * b / mu, 1.01 * b / mu}) {
      CAPTURE(mass, arm);
      System system({.gravity = {0, 0, -kG}});
      Body& body = system.add_body("clamp", block(mass, {arm, 0, 0}));
      const Lock& guide = system.add<Prismatic>("column", body, system.ground(), pose_at({0, 0, 0}));
      rub(system, guide, {.mu = mu, .bending_length = b, .load_smoothing = 1e-9});
      if (arm > b / mu)
        CHECK(rest(system).stability.kind == Kind::gripped);
      else
        testing::check_words(testing::message_of<SolveError>([&] { rest(system, {.relaxation_steps = 100}); }),
                             {"under the forces", "'clamp'"});
    }
}

// Two blocks on a slope, held apart by a rod: one pulls more than it carries, the other must help. They hold as long as
// the sum of both limits is enough, however unequal these are.
TEST_CASE("friction in several places is shared as far as the limits allow", "[verification][statics][friction]") {
  const double alpha = 0.3, mass = 2, heavy = 5, slippery = 0.05;
  const double needed = ((mass + heavy) * std::tan(alpha) - slippery * heavy) /
                        mass;  // of the block that is rough, (m1 + m2) tan = sum mu m
  for (const double share : {0.999, 1.001}) {
    CAPTURE(share);
    System system({.gravity = {0, 0, -kG}});
    Body& rough = system.add_body("rough", block(mass), pose_at(down_slope(alpha).x));
    Body& smooth = system.add_body("smooth", block(heavy), pose_at(down_slope(alpha, 0.5).x));
    const Lock& upper = system.add<Prismatic>("upper", rough, system.ground(), down_slope(alpha));
    const Lock& lower = system.add<Prismatic>("lower", smooth, system.ground(), down_slope(alpha, 0.5));
    system.add<Distance>("rod", system.add_marker_at("p", rough, down_slope(alpha)),
                         system.add_marker_at("s", smooth, down_slope(alpha, 0.5)));
    rub(system, upper, {.mu = share * needed});
    rub(system, lower, {.mu = slippery});
    if (share < 1) {
      const std::string said = testing::message_of<SolveError>([&] { rest(system, {.relaxation_steps = 100}); });
      CHECK(said.find("'upper.friction' (sliding) needs ") != std::string::npos);
      continue;
    }
    const EquilibriumReport found = rest(system);
    CHECK(found.stability.kind == Kind::gripped);
    CHECK(found.stability.freedoms == 1);
    REQUIRE(found.grips.size() == 2);
    CHECK(found.grips[0].carries + found.grips[1].carries ==
          Approx((mass + heavy) * kG * std::sin(alpha)).epsilon(1e-9));
    for (const GripReport& grip : found.grips) CHECK(grip.carries <= grip.most);
  }
}

TEST_CASE("joints that do not stick are judged separately, and equilibria without friction are found on request",
          "[verification][statics][friction]") {
  // A block that friction holds carries a pendulum, which hangs or stands.
  for (const bool hangs : {true, false}) {
    CAPTURE(hangs);
    System system({.gravity = {0, 0, -kG}});
    Body& body = system.add_body("block", block(3));
    Body& rod = system.add_body("rod", block(0.2, {0, 0, hangs ? -0.4 : 0.4}));
    const Lock& guide = system.add<Prismatic>("guide", body, system.ground(), pose_at({0, 0, 0}, Vec3::UnitX()));
    system.add<Revolute>("hinge", rod, body, pose_at({0, 0, 0}, Vec3::UnitY()));
    rub(system, guide, {.mu = 0.5});
    system.add(std::make_unique<AppliedForce>("push", system.add_marker_at("at", body, pose_at({0, 0, 0})),
                                              AppliedForce::Options{.force = Vec3(3, 0, 0)}));
    if (hangs)
      CHECK(rest(system).stability.kind == Kind::gripped);
    else
      testing::check_words(testing::message_of<SolveError>([&] { rest(system, {.relaxation_steps = 100}); }),
                           {"under the forces", "'block'"});  // the rod falls, and the block moves then
  }
  System system({.gravity = {0, -kG, 0}});
  Body& body = system.add_body("wheel", block(2, {0.01, -0.3, 0}));
  const Lock& hinge = system.add<Revolute>("bearing", body, system.ground(), pose_at({0, 0, 0}));
  rub(system, hinge, {.mu = 0.9, .radius = 0.05});
  CHECK(rest(system).stability.kind == Kind::gripped);
  const EquilibriumReport without = rest(system, {.friction = false});
  CHECK(without.stability.kind == Kind::stable);
  CHECK(without.grips.empty());
  CHECK(without.largest_move > 0.005);
}

// Friction could carry both blocks; but the lid above the first is a row that takes its load before friction does.
TEST_CASE("friction that could hold the start is not used if a one-sided joint would have to pull",
          "[verification][statics][friction]") {
  constexpr double mass = 2, stiffness = 1000;
  System system({.gravity = {0, -kG, 0}});
  for (const double x : {0.0, 1.0}) {
    const std::string name = x == 0 ? "first" : "second";
    Body& body = system.add_body(name, block(mass), {Vec3(x, 0, 0), {}});
    const Lock& rail = system.add<Prismatic>(name + " rail", body, system.ground(), pose_at({x, 0, 0}, Vec3::UnitY()));
    rub(system, rail, {.mu = 0.5, .preload = 100});
    system.add<SpringDamper>(name + " spring", system.add_marker_at(name + " P", body, pose_at({x, 0, 0})),
                             system.add_marker(name + " S", system.ground(), {Vec3(x, 1, 0), {}}),
                             {.stiffness = stiffness, .free_length = 1});
    if (x == 0)
      system.add<PointOnPlane>("lid", body, system.ground(), pose_at({x, 0, 0}, -Vec3::UnitY())).set_unilateral({});
  }
  const EquilibriumReport found = rest(system);
  CHECK(found.stability.kind == Kind::stable);
  CHECK_FALSE(found.by_friction);
  CHECK(found.largest_move == Approx(mass * kG / stiffness));
  REQUIRE(found.notes.size() == 2);
  testing::check_words(found.notes.front().text(), {"friction could hold the start", "'lid' would have to pull"});
}

}  // namespace friction_at_rest_test
