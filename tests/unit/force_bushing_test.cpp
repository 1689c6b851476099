// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/messages.h"

namespace force_bushing_test {

using namespace lockstep;
using oracle::ForceBench;

namespace {
Bushing::Options numbers() { return {Vec3(100, 200, 300), Vec3(1, 2, 3), Vec3(10, 20, 30), Vec3(0.1, 0.2, 0.3)}; }
}  // namespace

TEST_CASE("bushing: an offset and a rotation along the axes of S give the forces along them", "[unit][force]") {
  ForceBench bench;
  Bushing bushing("rubber", bench.p, bench.s, numbers());
  bushing.setup();
  const Quat tilt = normalized(Quat{0.8, 0.1, 0.5, -0.3});
  const Mat3 A = rotation(tilt);
  const Vec3 d(0.01, -0.02, 0.03);
  for (int k = 0; k < 3; ++k) {
    const double angle = 0.3;
    bench.place(bench.s, {Vec3(1, 2, 3), tilt});
    bench.place(bench.p, {Vec3(1, 2, 3) + A * d, tilt * axis_angle(Vec3::Unit(k), angle)}, A * Vec3(0.1, 0.2, 0.3));
    const Vec3 F = A * Vec3(-1 - 0.1, 4 - 0.4, -9 - 0.9);
    CHECK((bench.force_on(bushing, 0) - F).norm() < 1e-12);
    const Vec3 M = A * Vec3(-10 * (k + 1) * angle * Vec3::Unit(k));
    const Vec3 x = Vec3(1, 2, 3) + A * d;
    CHECK((bench.moment_about_origin(bushing, 0) - cross(x, F) - M).norm() < 1e-11);
    const double V = 0.5 * (100 * 1e-4 + 200 * 4e-4 + 300 * 9e-4) + 5 * (k + 1) * angle * angle;
    CHECK(bushing.potential(bench.in()) == Approx(V).epsilon(1e-12));
    CHECK(bushing.dissipation(bench.in()) == Approx(0.01 + 2 * 0.04 + 3 * 0.09).epsilon(1e-12));
    CHECK(bushing.quantity(oracle::quantity_index(bushing, "torque_on_p_link_x") + k, bench.in()) ==
          Approx(-10 * (k + 1) * angle).epsilon(1e-12));
    CHECK(bushing.quantity(1, bench.in()) == Approx(-0.02).epsilon(1e-12));
  }
}

TEST_CASE("bushing: momentum and power balance, for small and for large rotations", "[unit][force]") {
  for (double size : {1e-5, 0.05, 0.3, 2.4}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      ForceBench bench(seed);
      Bushing bushing("rubber", bench.p, bench.s, numbers());
      bushing.setup();
      oracle::Draw draw(seed + 100);
      const Quat q = Quat::from(draw.quaternion());
      const Vec3 x = draw.vector(1), th = size * draw.vector(1).normalized(), d = draw.vector(0.2), w = draw.vector(2);
      bench.place(bench.s, {x, q}, draw.vector(1), w);
      bench.place(bench.p, {x + d, q * exponential(th)}, draw.vector(1), w + draw.vector(0.5));
      CAPTURE(size, seed);
      CHECK((bench.force_on(bushing, 0) + bench.force_on(bushing, 1)).norm() < 1e-11);
      CHECK((bench.moment_about_origin(bushing, 0) + bench.moment_about_origin(bushing, 1)).norm() < 1e-10);
      const double Vd = bench.rate_of([&] { return bushing.potential(bench.in()); });
      CHECK(bench.power(bushing) == Approx(-Vd - bushing.dissipation(bench.in())).epsilon(1e-8).margin(1e-8));
      CHECK(bushing.quantity(oracle::quantity_index(bushing, "power"), bench.in()) ==
            Approx(bench.power(bushing)).epsilon(1e-11).margin(1e-11));
    }
  }
}

TEST_CASE("bushing: wrong input is rejected by name", "[unit][force]") {
  ForceBench bench;
  auto options = numbers();
  options.stiffness[1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(Bushing("rubber", bench.p, bench.s, options),
                    "force 'rubber': stiffness is [100, nan, 300]; must be finite numbers");
  options = numbers();
  options.torsion_damping[2] = -1;
  CHECK_THROWS_WITH(Bushing("rubber", bench.p, bench.s, options),
                    "force 'rubber': torsion_damping is -1; must be a finite number, 0 or more");
  bench.a.freedoms = Freedoms::particle;
  Bushing turning("rubber", bench.p, bench.s, numbers()),
      moving("rubber", bench.p, bench.s, {.stiffness = Vec3(1, 1, 1)});
  testing::check_words(testing::message_of<ModelError>([&] { turning.setup(); }),
                       {"force 'rubber'", "body 'a'", "is a particle"});
  bench.b.freedoms = Freedoms::particle;
  testing::check_words(testing::message_of<ModelError>([&] { moving.setup(); }),
                       {"force 'rubber'", "body 'b'", "is a particle"});
}

}  // namespace force_bushing_test
