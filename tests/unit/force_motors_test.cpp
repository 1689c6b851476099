// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/messages.h"

namespace force_motors_test {

using namespace lockstep;
using oracle::ForceBench;
using oracle::value_law;

TEST_CASE("torque_motor: a torque about z of S, its opposite, and its power", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ForceBench bench(seed);
    TorqueMotor motor("M", bench.p, bench.s, {value_law([](double t) { return 4 + t; })});
    motor.setup();
    bench.at(0.5);
    const Vec3 z = bench.motions[2].A * (rotation(bench.b.in_slot.q * bench.s.local.q).col(2));
    CHECK((bench.moment_on(motor, 0) - 4.5 * z).norm() < 1e-13);
    CHECK((bench.moment_on(motor, 1) + 4.5 * z).norm() < 1e-13);
    CHECK(bench.force_on(motor, 0).isZero(0));
    CHECK(motor.quantity(0, bench.in()) == 4.5);
    CHECK(motor.quantity(2, bench.in()) == Approx(bench.power(motor)).epsilon(1e-12));
    CHECK(motor.quantity(2, bench.in()) == Approx(4.5 * motor.quantity(1, bench.in())).epsilon(1e-12));
  }
}

TEST_CASE("force_motor: a force along z of S at P, its opposite on the same line, and its power", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ForceBench bench(seed);
    ForceMotor motor("M", bench.p, bench.s, {value_law([](double t) { return 4 + t; })});
    motor.setup();
    bench.at(0.5);
    const MarkerInWorld P = in_world(MarkerFrame(bench.p), bench.in());
    const Vec3 z = bench.motions[2].A * (rotation(bench.b.in_slot.q * bench.s.local.q).col(2));
    CHECK((bench.force_on(motor, 0) - 4.5 * z).norm() < 1e-13);
    CHECK((bench.moment_about_origin(motor, 0) - cross(P.x, Vec3(4.5 * z))).norm() < 1e-12);
    CHECK((bench.force_on(motor, 0) + bench.force_on(motor, 1)).norm() < 1e-13);
    CHECK((bench.moment_about_origin(motor, 0) + bench.moment_about_origin(motor, 1)).norm() < 1e-12);
    CHECK(motor.quantity(2, bench.in()) == Approx(bench.power(motor)).epsilon(1e-11).margin(1e-12));
    // the rate is that of the coordinate of P along z of S
    const double rate = bench.rate_of([&] {
      const MarkerInWorld p = in_world(MarkerFrame(bench.p), bench.in()),
                          s = in_world(MarkerFrame(bench.s), bench.in());
      return s.A.col(2).dot(p.x - s.x);
    });
    CHECK(motor.quantity(1, bench.in()) == Approx(rate).epsilon(1e-9).margin(1e-9));
  }
}

TEST_CASE("motors: missing laws and particles are rejected by name", "[unit][force]") {
  ForceBench bench;
  CHECK_THROWS_WITH(TorqueMotor("M", bench.p, bench.s, {}), "force 'M': torque is missing; give a law");
  CHECK_THROWS_WITH(ForceMotor("M", bench.p, bench.s, {}), "force 'M': force is missing; give a law");
  TorqueMotor torque("M", bench.p, bench.s, {value_law([](double) { return 1.0; })});
  ForceMotor force("M", bench.p, bench.s, {value_law([](double) { return 1.0; })});
  const auto refusal = [](Force& motor) { return testing::message_of<ModelError>([&] { motor.setup(); }); };
  bench.a.freedoms = Freedoms::particle;
  testing::check_words(refusal(torque), {"force 'M' (torque_motor) rotates body 'a'", "is a particle and cannot rotate"});
  CHECK(refusal(force) == "no error");
  bench.a.freedoms = Freedoms::spatial, bench.b.freedoms = Freedoms::particle;
  testing::check_words(refusal(torque), {"force 'M' (torque_motor) rotates body 'b'", "is a particle and cannot rotate"});
  testing::check_words(refusal(force),
                       {"force 'M' (force_motor) has a lever arm on body 'b'", "is a particle"});
}

}  // namespace force_motors_test
