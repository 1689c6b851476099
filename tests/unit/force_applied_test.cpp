// SPDX-License-Identifier: BSD-3-Clause

#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/messages.h"

namespace force_applied_test {

using namespace lockstep;
using oracle::ForceBench;
using oracle::kNaN;
using oracle::value_law;

namespace {
const Vec3 kF(1, -2, 3);
}  // namespace

TEST_CASE("applied_force: in axes of the world, the body and the marker", "[unit][force]") {
  ForceBench bench(5);
  bench.p.rotation_law = std::make_shared<oracle::SteadySpin>(Vec3(1, 2, 3));
  bench.p.translation_law = std::make_shared<oracle::SineSlide>(Vec3(0.1, 0.2, -0.3));
  bench.at(0.3);
  const Mat3 slot = bench.motions[1].A, body = slot * rotation(bench.a.in_slot.q);
  const Mat3 marker = body * rotation(bench.p.local.q) * rotation(exponential(Vec3(0.3, 0.6, 0.9)));
  const Vec3 u = bench.p.local.x + rotation(bench.p.local.q) * (std::sin(0.9) * Vec3(0.1, 0.2, -0.3));
  const Vec3 x = bench.motions[1].x + slot * (bench.a.in_slot.x + rotation(bench.a.in_slot.q) * u);
  const std::pair<AppliedAxes, Mat3> cases[] = {
      {AppliedAxes::world, Mat3::Identity()}, {AppliedAxes::body, body}, {AppliedAxes::marker, marker}};
  for (const auto& [axes, A] : cases) {
    AppliedForce force("push", bench.p, {.force = kF, .axes = axes});
    force.setup();
    CHECK((bench.force_on(force, 0) - A * kF).norm() < 1e-13);
    CHECK((bench.moment_about_origin(force, 0) - cross(x, Vec3(A * kF))).norm() < 1e-12);
    CHECK(bench.wrench(force).tail<6>().isZero(0));
    AppliedTorque torque("twist", bench.p, {.torque = kF, .axes = axes});
    torque.setup();
    CHECK((bench.moment_on(torque, 0) - A * kF).norm() < 1e-13);
    CHECK(bench.force_on(torque, 0).isZero(0));
    for (int k = 0; k < 3; ++k) {
      CHECK(force.quantity(k, bench.in()) == Approx((A * kF)[k]).epsilon(1e-13));
      CHECK(torque.quantity(k, bench.in()) == Approx((A * kF)[k]).epsilon(1e-13));
    }
    CHECK(force.quantity(3, bench.in()) == Approx(bench.power(force)).epsilon(1e-12));
    CHECK(torque.quantity(3, bench.in()) == Approx(bench.power(torque)).epsilon(1e-12));
  }
}

TEST_CASE("applied_force: constant, law along a direction and three laws add up", "[unit][force]") {
  ForceBench bench;
  bench.at(0.5);
  AppliedForce::Options options{
      .force = kF, .law = value_law([](double t) { return 10 * t; }), .direction = Vec3(0, 3, 4)};
  options.laws = {value_law([](double t) { return t; }), nullptr, value_law([](double t) { return t * t; })};
  AppliedForce force("push", bench.p, options);
  force.setup();
  CHECK((bench.force_on(force, 0) - Vec3(1 + 0.5, -2 + 3, 3 + 4 + 0.25)).norm() < 1e-14);
  std::vector<double> out;
  force.breakpoints(0, 1, out);
  CHECK(out.size() == 3);
}

TEST_CASE("applied forces with a reaction keep momentum", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ForceBench bench(seed);
    AppliedForce force("push", bench.p, bench.s, {.force = kF, .axes = AppliedAxes::body});
    AppliedTorque torque("twist", bench.p, bench.s, {.torque = kF, .axes = AppliedAxes::marker});
    for (MarkerForce* f : {static_cast<MarkerForce*>(&force), static_cast<MarkerForce*>(&torque)}) {
      f->setup();
      CHECK((bench.force_on(*f, 0) + bench.force_on(*f, 1)).norm() < 1e-13);
      CHECK((bench.moment_about_origin(*f, 0) + bench.moment_about_origin(*f, 1)).norm() < 1e-12);
      CHECK(f->observable()->quantity(3, bench.in()) == Approx(bench.power(*f)).epsilon(1e-11).margin(1e-12));
      CHECK(bench.wrench(*f).norm() > 1);
    }
  }
}

TEST_CASE("applied_force: a constant force in the world has a potential", "[unit][force]") {
  ForceBench bench(2);
  AppliedForce alone("push", bench.p, {.force = kF}), grounded("push", bench.p, bench.g, {.force = kF});
  for (AppliedForce* f : {&alone, &grounded}) {
    f->setup();
    const double Vd = bench.rate_of([&] { return f->potential(bench.in()); });
    CHECK(bench.power(*f) == Approx(-Vd).epsilon(1e-10));
  }
  AppliedForce turning("push", bench.p, {.force = kF, .axes = AppliedAxes::body});
  turning.setup();
  CHECK(turning.potential(bench.in()) == 0);
}

TEST_CASE("applied_force, applied_torque: wrong input is rejected by name", "[unit][force]") {
  ForceBench bench;
  CHECK_THROWS_WITH(AppliedForce("push", bench.p, {.force = Vec3(0, kNaN, 1)}),
                    "force 'push': force is [0, nan, 1]; must be finite numbers");
  CHECK_THROWS_WITH(AppliedForce("push", bench.p, {.law = value_law([](double) { return 1.0; })}),
                    "force 'push': direction is [0, 0, 0]; a law acts along a direction, give one");
  CHECK_THROWS_WITH(AppliedTorque("twist", bench.p, {.torque = Vec3(kNaN, 0, 0)}),
                    "force 'twist': torque is [nan, 0, 0]; must be finite numbers");
  bench.a.freedoms = Freedoms::particle;
  AppliedTorque torque("twist", bench.p, {.torque = kF});
  const auto refusal = [](Force& applied) { return testing::message_of<ModelError>([&] { applied.setup(); }); };
  testing::check_words(refusal(torque), {"force 'twist' (applied_torque) rotates body 'a'", "is a particle"});
  AppliedForce force("push", bench.p, {.force = kF}), reacting("push", bench.s, bench.p, {.force = kF});
  CHECK(refusal(force) == "no error");
  testing::check_words(refusal(reacting), {"force 'push' (applied_force)", "body 'a'", "is a particle"});
}

}  // namespace force_applied_test
