// SPDX-License-Identifier: BSD-3-Clause
// Closed-form scalar laws and laws from a user's function: values against the formula on jets, breakpoints, errors.
#include <array>
#include <limits>

#include <lockstep/error.h>
#include <lockstep/laws.h>
#include <lockstep/math.h>
#include "tests/support/law_checks.h"
#include "tests/support/messages.h"

namespace motionlaws_test {

using namespace lockstep;
using namespace lockstep::test;

TEST_CASE("constant, ramp, sine, fourier and polynomial follow their formulas", "[unit][motionlaws]") {
  check_formula(
      *laws::constant(0.7), [](auto t) { return 0.7 + 0.0 * t; }, -1, 1);
  check_formula(
      *laws::ramp(2.0, 0.5, -3.0), [](auto t) { return -3.0 + 2.0 * (t - 0.5); }, -4, 4);
  check_formula(
      *laws::sine({0.2, 5.0, 0.3, 1.0}), [](auto t) { return 1.0 + 0.2 * sin(5.0 * t + 0.3); }, -4, 4);
  check_formula(
      *laws::fourier({2.0, 0.1, {0.3, -0.2, 0.05}, {0.4}}),
      [](auto t) { return 0.1 + 0.3 * cos(2.0 * t) + 0.4 * sin(2.0 * t) - 0.2 * cos(4.0 * t) + 0.05 * cos(6.0 * t); },
      -4, 4);
  check_formula(
      *laws::polynomial({1.0, -2.0, 0.5, 0.25}, 0.4),
      [](auto t) {
        const auto u = t - 0.4;
        return 1.0 - 2.0 * u + 0.5 * u * u + 0.25 * u * u * u;
      },
      -2, 2);
  for (const auto& smooth : {laws::constant(0.7), laws::ramp(2.0), laws::sine({.amplitude = 2, .omega = 3}), laws::polynomial({1, 2, 3})})
    check_breakpoints(*smooth, -2, 2, {});
}

TEST_CASE("rises follow their formulas inside and rest outside", "[unit][motionlaws]") {
  const RiseSettings k{.rise = -0.3, .duration = 2.0, .t0 = 0.5, .y0 = 1.0};
  const auto u = [](auto t) { return (t - 0.5) / 2.0; };
  check_formula(
      *laws::poly345(k), [&](auto t) { return 1.0 - 0.3 * (10.0 * pow(u(t), 3) - 15.0 * pow(u(t), 4) + 6.0 * pow(u(t), 5)); },
      0.6, 2.4);
  check_formula(
      *laws::cycloid(k), [&](auto t) { return 1.0 - 0.3 * (u(t) - sin(kTwoPi * u(t)) / kTwoPi); }, 0.5, 2.499);
  check_formula(
      *laws::harmonic_rise(k), [&](auto t) { return 1.0 - 0.15 * (1.0 - cos(kPi * u(t))); }, 0.5, 2.499);
  for (const auto& law : {laws::poly345(k), laws::cycloid(k), laws::harmonic_rise(k)}) {
    check_formula(
        *law, [](auto t) { return 1.0 + 0.0 * t; }, -3, 0.499);
    check_formula(
        *law, [](auto t) { return 0.7 + 0.0 * t; }, 2.5, 9);
  }
  for (const auto& law : {laws::poly345(k), laws::cycloid(k), laws::harmonic_rise(k)})
    check_breakpoints(*law, -1, 4, {0.5, 2.5});
  CHECK(breakpoints_of(*laws::harmonic_rise(k), 0.5, 2.5).empty());  // the interval is open
}

TEST_CASE("trapezoid: three ways to give the same motion", "[unit][motionlaws]") {
  // 0.2 s at 5, then 0.8 s at speed 1, then 0.2 s at -5: distance 0.1 + 0.8 + 0.1
  for (const TrapezoidSettings& k :
       {TrapezoidSettings{.distance = 1, .speed = 1, .acceleration = 5, .t0 = 0.3, .y0 = 2},
        TrapezoidSettings{.distance = 1, .acceleration = 5, .duration = 1.2, .t0 = 0.3, .y0 = 2},
        TrapezoidSettings{.distance = 1, .speed = 1, .duration = 1.2, .t0 = 0.3, .y0 = 2}}) {
    const auto law = laws::trapezoid(k);
    check_formula(
        *law, [](auto t) { return 2.0 + 0.0 * t; }, -1, 0.299);
    check_formula(
        *law, [](auto t) { return 2.0 + 2.5 * (t - 0.3) * (t - 0.3); }, 0.3, 0.499);
    check_formula(
        *law, [](auto t) { return 2.1 + (t - 0.5) + 0.0 * t * t; }, 0.5 + 1e-9, 1.299);
    check_formula(
        *law, [](auto t) { return 3.0 - 2.5 * (1.5 - t) * (1.5 - t); }, 1.3 + 1e-9, 1.499);
    check_formula(
        *law, [](auto t) { return 3.0 + 0.0 * t; }, 1.5, 4);
    check_breakpoints(*law, 0, 2, {0.3, 0.5, 1.3, 1.5});
  }
}

TEST_CASE("trapezoid: a short way is a triangle, a way back is negative, no way is no motion", "[unit][motionlaws]") {
  // 2 sqrt(d/a) = 0.4 s
  check_breakpoints(*laws::trapezoid({.distance = -0.2, .speed = 100, .acceleration = 5}), -1, 1, {0, 0.2, 0.4});
  check_breakpoints(*laws::trapezoid({.distance = 0.2, .acceleration = 5, .duration = 0.4}), -1, 1, {0, 0.2, 0.4});
  CHECK(laws::trapezoid({.distance = -0.2, .speed = 100, .acceleration = 5})->at(5).y == -0.2);
  check_breakpoints(*laws::trapezoid({.distance = 0, .speed = 100, .acceleration = 5, .y0 = 3}), -1, 1, {});
  CHECK(laws::trapezoid({.distance = 0, .speed = 100, .acceleration = 5, .y0 = 3})->at(0.5).y == 3);
}

TEST_CASE("laws from a function have exact derivatives and the declared breakpoints", "[unit][motionlaws]") {
  const auto swing = laws::law([](auto t) { return 0.1 * sin(3.0 * t); });
  for (const double t : {-0.4, 0.0, 1.7}) {
    CHECK(swing->at(t).y == Approx(0.1 * std::sin(3 * t)).margin(1e-15));
    CHECK(swing->at(t).yd == Approx(0.3 * std::cos(3 * t)).margin(1e-15));
    CHECK(swing->at(t).ydd == Approx(-0.9 * std::sin(3 * t)).margin(1e-15));
  }
  check_breakpoints(*swing, -1, 1, {});
  const auto kink = laws::law([](auto t) { return t < 0.25 ? 0.0 * t : (t - 0.25) * (t - 0.25); }, {0.25});
  check_breakpoints(*kink, -1, 1, {0.25});

  const auto circle = laws::translation(
      [](auto t) {
        return std::array{0.2 * cos(2.0 * t), 0.2 * sin(2.0 * t), 0.1 * t};
      },
      {3.0});
  const TranslationValue c = circle->at(0.6);
  const double co = 0.2 * std::cos(1.2), si = 0.2 * std::sin(1.2);
  CHECK((c.x - Vec3(co, si, 0.06)).norm() < 1e-15);
  CHECK((c.v - Vec3(-2 * si, 2 * co, 0.1)).norm() < 1e-15);
  CHECK((c.a - Vec3(-4 * co, -4 * si, 0)).norm() < 1e-15);
  std::vector<double> b;
  circle->breakpoints(0, 5, b);
  circle->breakpoints(3, 5, b);
  CHECK(b == std::vector<double>{3.0});
}

TEST_CASE("laws reject impossible arguments, by name, value and limit", "[unit][motionlaws]") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  testing::check_words(testing::message_of<ModelError>([&] { laws::constant(nan); }), {"constant", "is nan"});
  CHECK_THROWS_WITH(laws::ramp(inf), says("ramp") && says("slope is inf"));
  CHECK_THROWS_WITH(laws::sine({.phase = nan}), says("sine") && says("phase is nan"));
  CHECK_THROWS_WITH(laws::fourier({.cosines = {1, nan}}), says("fourier") && says("cosines"));
  CHECK_THROWS_WITH(laws::polynomial({}), says("polynomial") && says("coefficients is empty"));
  CHECK_THROWS_WITH(laws::poly345({.duration = 0}), says("poly345") && says("duration is 0; must be above 0"));
  CHECK_THROWS_WITH(laws::cycloid({.duration = -1}), says("cycloid") && says("duration is -1"));
  CHECK_THROWS_WITH(laws::harmonic_rise({.rise = nan}), says("harmonic_rise") && says("rise is nan"));
  CHECK_THROWS_WITH(laws::trapezoid({.speed = 1}), says("1 are given; give two"));
  CHECK_THROWS_WITH(laws::trapezoid({.speed = 1, .acceleration = 1, .duration = 1}), says("3 are given"));
  CHECK_THROWS_WITH(laws::trapezoid({.acceleration = 4, .duration = 0.9}), says("duration is 0.9 s") && says("at least 1 s"));
  CHECK_THROWS_WITH(laws::trapezoid({.speed = 0.9, .duration = 1}), says("speed is 0.9") && says("above 1 and at most 2"));
  CHECK_THROWS_WITH(laws::trapezoid({.speed = 2.1, .duration = 1}), says("speed is 2.1"));
  CHECK_THROWS_WITH(laws::trapezoid({.speed = -1, .acceleration = 1}), says("speed is -1; must be above 0"));
}

}  // namespace motionlaws_test
