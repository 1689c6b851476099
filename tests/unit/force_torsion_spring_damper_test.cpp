// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>

#include <lockstep/forces.h>
#include <lockstep/integrators.h>
#include <lockstep/joints.h>
#include <lockstep/solvers.h>
#include <lockstep/step_loop.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/messages.h"

namespace force_torsion_spring_damper_test {

using namespace lockstep;
using oracle::ForceBench;
using oracle::kNaN;

namespace {
TorsionSpringDamper::Options torsion_options() { return {3.0, 0.4, 0.7, 0.2, {}}; }
const Quat kTilt = normalized(Quat{0.9, 0.3, -0.2, 0.25});

// P turned by `angle` about z of S at the rate `rate`; S tilted in the world and turning too.
void turn_to(ForceBench& bench, double angle, double rate) {
  const Vec3 z = rotation(kTilt).col(2), w(0.3, -0.5, 0.2);
  bench.place(bench.s, {Vec3(1, 0, 2), kTilt}, Vec3::Zero(), w);
  bench.place(bench.p, {Vec3(1, 0, 2), kTilt * axis_angle(Vec3::UnitZ(), angle)}, Vec3::Zero(), w + rate * z);
}
}  // namespace

TEST_CASE("torsion_spring_damper: about a common axis it is the textbook's", "[unit][force]") {
  ForceBench bench;
  auto options = torsion_options();
  options.torque = oracle::value_law([](double) { return 0.05; });
  TorsionSpringDamper spring("coil", bench.p, bench.s, options);
  spring.setup();
  turn_to(bench, 1.3, 2.0);
  const double T = 3.0 * (1.3 - 0.7) + 0.2 + 0.4 * 2.0 + 0.05;
  CHECK(spring.quantity(0, bench.in()) == Approx(1.3).epsilon(1e-14));
  CHECK(spring.quantity(1, bench.in()) == Approx(2.0).epsilon(1e-13));
  CHECK(spring.quantity(2, bench.in()) == Approx(T).epsilon(1e-13));
  CHECK((bench.moment_on(spring, 0) + T * rotation(kTilt).col(2)).norm() < 1e-13);
  CHECK((bench.moment_on(spring, 1) - T * rotation(kTilt).col(2)).norm() < 1e-13);
  CHECK(spring.potential(bench.in()) == Approx(1.5 * 0.36 + 0.2 * 0.6).epsilon(1e-13));
  CHECK(spring.dissipation(bench.in()) == Approx(0.4 * 4).epsilon(1e-13));
  CHECK(spring.quantity(3, bench.in()) == Approx(-2.0 * T).epsilon(1e-13));
}

TEST_CASE("torsion_spring_damper: momentum and power balance, for axes that are not common too", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ForceBench bench(seed);
    for (Motion& m : bench.start) m.w *= 0.3;  // so that the difference stays on one branch
    TorsionSpringDamper spring("coil", bench.p, bench.s, torsion_options());
    spring.MarkerForce::setup();
    spring.count_angles(bench.angles);
    bench.angles.all.front()->set(bench.in(), 0, bench.angles.states);
    const double zz =
        in_world(MarkerFrame(bench.p), bench.in()).A.col(2).dot(in_world(MarkerFrame(bench.s), bench.in()).A.col(2));
    if (zz < -0.8) continue;  // too near to where there is no angle for the difference
    const double Vd = bench.rate_of([&] { return spring.potential(bench.in()); });
    const double thd = bench.rate_of([&] { return spring.quantity(0, bench.in()); });
    CAPTURE(seed, zz);
    CHECK((bench.moment_on(spring, 0) + bench.moment_on(spring, 1)).norm() < 1e-12);
    CHECK(bench.force_on(spring, 0).norm() + bench.force_on(spring, 1).norm() == 0);
    CHECK(spring.quantity(1, bench.in()) == Approx(thd).epsilon(1e-8).margin(1e-9));
    CHECK(bench.power(spring) == Approx(-Vd - spring.dissipation(bench.in())).epsilon(1e-8).margin(1e-9));
    CHECK(spring.quantity(3, bench.in()) == Approx(bench.power(spring)).epsilon(1e-12).margin(1e-13));
  }
}

TEST_CASE("torsion_spring_damper: ten revolutions and back are counted, rejected steps leave no trace",
          "[unit][force]") {
  ForceBench bench;
  TorsionSpringDamper spring("coil", bench.p, bench.s, torsion_options());
  spring.setup();
  spring.count_angles(bench.angles);
  REQUIRE(bench.angles.all.size() == 1);
  const CountedAngle& counted = *bench.angles.all.front();
  const auto expected = [&] { return counted.expected(bench.in().s); };
  CHECK(expected() == 0);
  const double step = 0.37;  // rad an accepted step
  double angle = -0.9;
  const auto accepted_to = [&](double to) {
    const double last = expected();
    for (double trial : {1.7, -2.9, 3.0}) {  // tried and rejected, up to nearly half a turn away
      turn_to(bench, angle + trial, 0);
      CHECK(spring.quantity(0, bench.in()) == Approx(angle + trial).margin(1e-11));
      CHECK(expected() == last);
    }
    angle = to;
    turn_to(bench, angle, 1.0);
    CHECK(spring.quantity(0, bench.in()) == Approx(angle).margin(1e-11));
    CHECK(spring.quantity(2, bench.in()) == Approx(3.0 * (angle - 0.7) + 0.2 + 0.4).margin(1e-10));
    counted.accept(bench.in(), bench.angles.states);
  };
  turn_to(bench, angle, 0);
  counted.accept(bench.in(), bench.angles.states);
  while (angle < 10 * kTwoPi) accepted_to(angle + step);
  while (angle > -10 * kTwoPi) accepted_to(angle - step);
  CHECK(expected() == Approx(angle).margin(1e-11));
}

TEST_CASE("torsion_spring_damper: the sign of a quaternion does not matter", "[unit][force]") {
  ForceBench bench;
  TorsionSpringDamper spring("coil", bench.p, bench.s, torsion_options());
  spring.setup();
  turn_to(bench, 2.5, 0.1);
  const VecX f = bench.wrench(spring);
  bench.start[0].e = -bench.start[0].e;
  bench.at(0);
  CHECK((bench.wrench(spring) - f).norm() < 1e-13);
}

TEST_CASE("torsion_spring_damper: a marker's spin is part of the angle", "[unit][force]") {
  ForceBench bench;
  bench.p.rotation_law = std::make_shared<oracle::SteadySpin>(Vec3(0, 0, 1.5));
  TorsionSpringDamper spring("coil", bench.p, bench.s, torsion_options());
  spring.setup();
  turn_to(bench, 0.2, 0.0);
  const Motion still[2] = {bench.start[0], bench.start[1]};
  bench.start[0].w.setZero(), bench.start[1].w.setZero();
  bench.at(0.4);
  CHECK(spring.quantity(0, bench.in()) == Approx(0.2 + 0.6).epsilon(1e-13));
  CHECK(spring.quantity(1, bench.in()) == Approx(1.5).epsilon(1e-13));
  CHECK(still[0].w.norm() > 0);
}

TEST_CASE("torsion_spring_damper: wrong input is rejected by name", "[unit][force]") {
  ForceBench bench;
  CHECK_THROWS_WITH(TorsionSpringDamper("coil", bench.p, bench.s, {kNaN, 0, 0, 0, {}}),
                    "force 'coil': stiffness is nan; must be a finite number");
  CHECK_THROWS_WITH(TorsionSpringDamper("coil", bench.p, bench.s, {1, -2, 0, 0, {}}),
                    "force 'coil': damping is -2; must be a finite number, 0 or more");
  testing::check_words(testing::message_of<ModelError>([&] {
                         TorsionSpringDamper("coil", bench.p, bench.s, {1, 1, kNaN, 0, {}});
                       }),
                       {"free_angle is nan"});
  testing::check_words(testing::message_of<ModelError>([&] {
                         TorsionSpringDamper("coil", bench.p, bench.s, {1, 1, 1, kNaN, {}});
                       }),
                       {"preload is nan"});

  TorsionSpringDamper spring("coil", bench.p, bench.s, torsion_options());
  bench.b.freedoms = Freedoms::particle;
  CHECK_THROWS_WITH(spring.setup(),
                    "force 'coil' (torsion_spring_damper) rotates body 'b' at marker 's', but 'b' is a particle "
                    "and cannot rotate; give it an inertia (add_body), or use another body");
  bench.b.freedoms = Freedoms::spatial;

  const Quat q = (bench.b.home * bench.s.local).q;  // z against z
  bench.p.local = inverse(bench.a.home) * Pose{Vec3::Zero(), q * axis_angle(Vec3::UnitX(), kPi)};
  testing::check_words(testing::message_of<ModelError>([&] { spring.setup(); }),
                       {"force 'coil'", "opposed at the start", "rotate one marker"});
}

TEST_CASE("torsion_spring_damper: several revolutions in a step are counted by the rates", "[unit][force]") {
  // A rotor on a coil: angle = w0/n sin(n t), n^2 = k/J; 50 rad/s and steps of 0.1 s are 5 rad a step.
  const double k = 0.5, J = 1.0, w0 = 50, n = std::sqrt(k / J);
  System system;
  Body& rotor = system.add_body("rotor", MassProperties{1.0, Vec3::Zero(), Vec3(J, J, J).asDiagonal()});
  rotor.start.w = {0, 0, w0};
  system.add<Revolute>("hinge", rotor, system.ground(), pose_at(Vec3::Zero()));
  Marker &p = system.add_marker("p", rotor), &s = system.add_marker("s", system.ground());
  auto& coil = system.add<TorsionSpringDamper>("coil", p, s, TorsionSpringDamper::Options{k, 0, 0, 0, {}});
  Dynamics dynamics(system, std::make_unique<SchurSolver>());
  StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 0.1});
  run.run_until(10);
  CHECK(coil.quantity(0, dynamics.inputs(run.state())) == Approx(w0 / n * std::sin(n * 10)).epsilon(1e-5));
}

}  // namespace force_torsion_spring_damper_test
