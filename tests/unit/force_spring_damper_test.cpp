// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include <lockstep/forces.h>
#include "tests/support/catch.h"
#include "tests/support/force_bench.h"
#include "tests/support/messages.h"

namespace force_spring_damper_test {

using namespace lockstep;
using oracle::ForceBench;
using oracle::kNaN;

namespace {
SpringDamper::Options spring_options() { return {120.0, 7.0, 0.3, 11.0, {}}; }
std::string refusal(const SpringDamper::Options& options) {
  ForceBench bench;
  try {
    SpringDamper("coil", bench.p, bench.s, options);
  } catch (const ModelError& e) {
    return e.what();
  }
  return "";
}
}  // namespace

TEST_CASE("spring_damper: a known length and rate give a known force on the line", "[unit][force]") {
  ForceBench bench;
  bench.place(bench.p, {Vec3(4, 6, 1), bench.start[0].e}, Vec3(0.5, 0.25, 9));  // 3-4-5 from S, 9 across the line
  bench.place(bench.s, {Vec3(1, 2, 1), bench.start[1].e});
  auto options = spring_options();
  options.force = oracle::value_law([](double t) { return 2 + t; });
  SpringDamper spring("coil", bench.p, bench.s, options);
  spring.setup();
  // n = (0.6, 0.8, 0), ld = 0.3 + 0.2, T = 120 (5 - 0.3) + 11 + 7 0.5 + 2
  const double T = 120 * 4.7 + 11 + 3.5 + 2;
  CHECK(spring.quantity(0, bench.in()) == Approx(5).epsilon(1e-14));
  CHECK(spring.quantity(1, bench.in()) == Approx(0.5).epsilon(1e-13));
  CHECK(spring.quantity(2, bench.in()) == Approx(T).epsilon(1e-14));
  CHECK((bench.force_on(spring, 0) + T * Vec3(0.6, 0.8, 0)).norm() < 1e-11);
  CHECK((bench.moment_about_origin(spring, 0) + T * cross(Vec3(1, 2, 1), Vec3(0.6, 0.8, 0))).norm() < 1e-10);
  CHECK(spring.potential(bench.in()) == Approx(60 * 4.7 * 4.7 + 11 * 4.7).epsilon(1e-14));
  CHECK(spring.dissipation(bench.in()) == Approx(7 * 0.25).epsilon(1e-13));
  REQUIRE(spring.quantities().size() == 4);
  CHECK(spring.quantities()[2].name == "force");
  CHECK(spring.quantities()[2].unit == "N");
}

TEST_CASE("spring_damper: momentum is conserved, and power agrees with potential, damper and law", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ForceBench bench(seed);
    auto options = spring_options();
    options.force = oracle::value_law([](double) { return 5.0; });
    SpringDamper spring("coil", bench.p, bench.s, options);
    spring.setup();
    CAPTURE(seed);
    CHECK((bench.force_on(spring, 0) + bench.force_on(spring, 1)).norm() < 1e-11);
    CHECK((bench.moment_about_origin(spring, 0) + bench.moment_about_origin(spring, 1)).norm() < 1e-10);
    const double Vd = bench.rate_of([&] { return spring.potential(bench.in()); });
    const double by_law = -5.0 * spring.quantity(1, bench.in());
    CHECK(bench.power(spring) == Approx(-Vd - spring.dissipation(bench.in()) + by_law).epsilon(1e-8).margin(1e-7));
    CHECK(spring.quantity(3, bench.in()) == Approx(bench.power(spring)).epsilon(1e-11).margin(1e-10));
    CHECK(spring.dissipation(bench.in()) >= 0);
  }
}

TEST_CASE("spring_damper: moving markers carry its ends", "[unit][force]") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ForceBench bench(seed);
    bench.p.translation_law = std::make_shared<oracle::SineSlide>(Vec3(0.3, -0.2, 0.4));
    bench.s.translation_law = std::make_shared<oracle::SineSlide>(Vec3(-0.1, 0.5, 0.2));
    bench.s.rotation_law = std::make_shared<oracle::SteadySpin>(Vec3(1, 2, 3));
    SpringDamper spring("coil", bench.p, bench.s, spring_options());
    spring.setup();
    bench.at(0.2);
    const double rate = bench.rate_of([&] { return spring.quantity(0, bench.in()); });
    CAPTURE(seed);
    CHECK(spring.quantity(1, bench.in()) == Approx(rate).epsilon(1e-7).margin(1e-7));
    CHECK((bench.moment_about_origin(spring, 0) + bench.moment_about_origin(spring, 1)).norm() < 1e-10);
    CHECK(spring.quantity(3, bench.in()) == Approx(bench.power(spring)).epsilon(1e-11).margin(1e-10));
  }
}

TEST_CASE("spring_damper: the ground takes its end, and nothing else changes", "[unit][force]") {
  ForceBench bench(3);
  SpringDamper spring("coil", bench.p, bench.g, spring_options());
  spring.setup();
  const double Vd = bench.rate_of([&] { return spring.potential(bench.in()); });
  CHECK(bench.force_on(spring, 1).norm() == 0);
  CHECK(bench.power(spring) == Approx(-Vd - spring.dissipation(bench.in())).epsilon(1e-9));
}

TEST_CASE("spring_damper: no length, no direction, no force and no NaN", "[unit][force]") {
  ForceBench bench;
  bench.p.local = bench.s.local = bench.a.in_slot = bench.b.in_slot = {};  // so that the length is exactly zero
  bench.place(bench.p, {Vec3(1, 2, 3), {}}, Vec3(1, 0, 0));
  bench.place(bench.s, {Vec3(1, 2, 3), {}});
  bench.a.home.x = Vec3(1, 2, 3), bench.b.home.x = Vec3(5, 2, 3);
  SpringDamper spring("coil", bench.p, bench.s, spring_options());
  spring.setup();
  CHECK(spring.quantity(0, bench.in()) == 0);
  CHECK(bench.wrench(spring).isZero(0));
  CHECK(spring.quantity(2, bench.in()) == 0);
  CHECK(spring.potential(bench.in()) == Approx(60 * 0.09 - 11 * 0.3));
  bench.motions[1].x[0] = kNaN;  // but a NaN stays one
  CHECK_FALSE(bench.wrench(spring).allFinite());

  bench.b.home.x = Vec3(1, 2, 3);  // now they coincide at the start
  testing::check_words(testing::message_of<ModelError>([&] { spring.setup(); }),
                       {"force 'coil'", "coincide at the start", "has no direction"});
  SpringDamper soft("coil", bench.p, bench.s, {120.0, 7.0, 0.0, 0.0, {}});
  CHECK_NOTHROW(soft.setup());
}

TEST_CASE("spring_damper: wrong numbers are rejected by name", "[unit][force]") {
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(refusal({kNaN, 0, 0, 0, {}}).find("force 'coil': stiffness is nan") == 0);
  CHECK(refusal({1, inf, 0, 0, {}}).find("force 'coil': damping is inf") == 0);
  CHECK(refusal({1, -1, 0, 0, {}}).find("force 'coil': damping is -1") == 0);
  CHECK(refusal({1, 1, -0.5, 0, {}}).find("force 'coil': free_length is -0.5") == 0);
  CHECK(refusal({1, 1, 0.5, kNaN, {}}).find("force 'coil': preload is nan") == 0);
  CHECK(refusal({-100, 0, 0.5, 0, {}}).empty());  // a negative stiffness pushes away, and may

  ForceBench bench;
  Marker other{"other", &bench.a, {}};
  testing::check_words(testing::message_of<ModelError>([&] { SpringDamper("coil", bench.p, other, spring_options()); }),
                       {"force 'coil'", "both markers are on body"});
  Marker loose{"loose", nullptr, {}};
  testing::check_words(testing::message_of<ModelError>([&] { SpringDamper("coil", bench.p, loose, spring_options()); }),
                       {"force 'coil'", "marker 'loose' is not on a body"});
}

TEST_CASE("spring_damper: the instants of its laws are handed on", "[unit][force]") {
  ForceBench bench;
  auto options = spring_options();
  options.force = oracle::value_law([](double t) { return t; });
  SpringDamper spring("coil", bench.p, bench.s, options);
  std::vector<double> out;
  spring.breakpoints(0, 1, out);
  CHECK(out == std::vector<double>{0.25});
}

}  // namespace force_spring_damper_test
