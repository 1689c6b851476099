// SPDX-License-Identifier: BSD-3-Clause
// Sequence, repeat and the combinations: values against formulas, breakpoints found where they are and nowhere else.
#include <lockstep/error.h>
#include <lockstep/laws.h>
#include <lockstep/math.h>
#include "tests/support/law_checks.h"
#include "tests/support/messages.h"

namespace motionlaws_combine_test {

using namespace lockstep;
using namespace lockstep::test;

namespace {
const LawPtr<MotionLaw> kStart = laws::trapezoid({.distance = 1, .speed = 1, .acceleration = 5});  // jumps at 0, 0.2, 1, 1.2
}

TEST_CASE("sum, product, scale and shift follow their formulas", "[unit][motionlaws]") {
  const auto a = laws::sine({2.0, 3.0, 0.1, 0.5}), b = laws::polynomial({1.0, 0.3, -0.2}), c = laws::ramp(0.7);
  const auto fa = [](auto t) { return 0.5 + 2.0 * sin(3.0 * t + 0.1); };
  const auto fb = [](auto t) { return 1.0 + 0.3 * t - 0.2 * t * t; };
  check_formula(
      *laws::sum({a, b, c}), [&](auto t) { return fa(t) + fb(t) + 0.7 * t; }, -2, 2);
  check_formula(
      *laws::product({a, b, c}), [&](auto t) { return fa(t) * fb(t) * 0.7 * t; }, -2, 2);
  check_formula(
      *laws::scale(a, -3.0, 0.2), [&](auto t) { return 0.2 - 3.0 * fa(t); }, -2, 2);
  check_formula(
      *laws::shift(a, 0.4), [&](auto t) { return fa(t - 0.4); }, -2, 2);
}

TEST_CASE("combinations pass breakpoints on", "[unit][motionlaws]") {
  const auto kick = laws::harmonic_rise({.duration = 0.5, .t0 = 0.1});
  check_breakpoints(*laws::sum({kStart, kick}), -1, 3, {0, 0.1, 0.2, 0.6, 1, 1.2});
  check_breakpoints(*laws::product({laws::sum({laws::constant(1), kick}), laws::ramp(1, -5)}), -1, 3, {0.1, 0.6});
  check_breakpoints(*laws::scale(kStart, 2), -1, 3, {0, 0.2, 1, 1.2});
  check_breakpoints(*laws::scale(kStart, 0, 2), -1, 3, {});
  check_breakpoints(*laws::shift(kStart, 0.1), -1, 3, {0.1, 0.3, 1.1, 1.3});
  check_breakpoints(*laws::shift(kStart, -0.1), 0.05, 1, {0.1, 0.9});
}

TEST_CASE("rounding puts no breakpoint of a delayed law onto an end of the interval", "[unit][motionlaws]") {
  const auto late = laws::shift(laws::repeat(laws::harmonic_rise({.duration = 0.15}), 0.3, {.drift = true}), 0.1);
  std::vector<double> all;
  late->breakpoints(-1, 3, all);
  CHECK(all.size() > 20);
  for (const double t : all) {
    std::vector<double> before, after;
    late->breakpoints(-1, t, before), late->breakpoints(t, 3, after);
    INFO("at t = " << t);
    CHECK(std::ranges::all_of(before, [t](double b) { return b < t; }));
    CHECK(std::ranges::all_of(after, [t](double b) { return b > t; }));
  }
}

TEST_CASE("sequence: each law on its own time, values as given or chained, held or running on", "[unit][motionlaws]") {
  const std::vector<Piece> pieces{{2.0, laws::ramp(1.0)}, {1.0, laws::constant(5.0)}, {0.5, laws::polynomial({1.0, 0.0, 4.0})}};
  const auto plain = laws::sequence(pieces, {.t0 = 1});
  check_formula(
      *plain, [](auto t) { return t - 1.0; }, 1, 2.999);
  check_formula(
      *plain, [](auto t) { return 5.0 + 0.0 * t; }, 3, 3.999);
  check_formula(
      *plain, [](auto t) { return 1.0 + 4.0 * (t - 4.0) * (t - 4.0); }, 4, 4.499);
  check_formula(
      *plain, [](auto t) { return 2.0 + 0.0 * t; }, 4.5, 9);
  check_formula(
      *plain, [](auto t) { return 0.0 * t; }, -3, 0.999);
  check_breakpoints(*plain, 0, 6, {1, 3, 4, 4.5});

  const auto chained = laws::sequence(pieces, {.t0 = 1, .chained = true});
  check_formula(
      *chained, [](auto t) { return 2.0 + 0.0 * t; }, 3, 3.999);
  check_formula(
      *chained, [](auto t) { return 2.0 + 4.0 * (t - 4.0) * (t - 4.0); }, 4, 4.499);
  check_formula(
      *chained, [](auto t) { return 3.0 + 0.0 * t; }, 4.5, 9);
  check_breakpoints(*chained, 0, 6, {1, 3, 4, 4.5});

  const auto onward = laws::sequence(pieces, {.t0 = 1, .run_on = true});
  check_formula(
      *onward, [](auto t) { return t - 1.0; }, -5, 2.999);
  check_formula(
      *onward, [](auto t) { return 1.0 + 4.0 * (t - 4.0) * (t - 4.0); }, 4, 9);
  check_breakpoints(*onward, 0, 6, {3, 4});
}

TEST_CASE("sequence lists the times at which pieces meet", "[unit][motionlaws]") {
  check_breakpoints(
      *laws::sequence({{1, laws::poly345({})}, {1, laws::constant(0)}, {2, laws::cycloid({.duration = 2})}},
                      {.chained = true}),
      -1, 6, {0, 1, 2, 4});
  // A trapezoid stops with a jump exactly where it hands over, once, and its inner jumps come along.
  check_breakpoints(*laws::sequence({{1.2, kStart}, {1.0, laws::constant(1)}}, {}), -1, 6, {0, 0.2, 1, 1.2, 2.2});
  check_breakpoints(*laws::sequence({{1.2, kStart}, {1.2, kStart}}, {.t0 = 0.3, .chained = true}), -1, 6,
                    {0.3, 0.5, 1.3, 1.5, 1.7, 2.5, 2.7});
  // A piece that is cut short: the jumps after the cut do not happen, the cut is one.
  check_breakpoints(*laws::sequence({{0.5, kStart}, {1, laws::constant(0)}}, {.chained = true}), -1, 6,
                    {0, 0.2, 0.5, 1.5});
  const auto sines = laws::sequence({{1, laws::sine({})}, {1, laws::shift(laws::sine({}), -1)}}, {.run_on = true});
  CHECK(breakpoints_of(*sines, -1, 6) == std::vector<double>{1});
}

TEST_CASE("repeat: periods, drift, and jumps at the seam", "[unit][motionlaws]") {
  const auto saw = laws::repeat(laws::ramp(2.0), 0.5, {.t0 = 0.1});
  check_formula(
      *saw, [](auto t) { return 2.0 * (t - 0.1); }, 0.1, 0.599);
  check_formula(
      *saw, [](auto t) { return 2.0 * (t + 0.4); }, -0.4 + 1e-9, 0.099);
  check_formula(
      *saw, [](auto t) { return 2.0 * (t - 100.1); }, 100.1 + 1e-9, 100.599, 1e-12);
  check_breakpoints(*saw, -0.7, 0.7, {-0.4, 0.1, 0.6});
  check_breakpoints(*laws::repeat(laws::ramp(2.0), 0.5, {.drift = true}), -2, 2, {});
  check_formula(
      *laws::repeat(laws::ramp(2.0), 0.5, {.drift = true}), [](auto t) { return 2.0 * t; }, -5, 5);
  check_breakpoints(*laws::repeat(laws::sine({.omega = kTwoPi}), 1), -3, 3, {});
  check_breakpoints(*laws::repeat(laws::poly345({}), 1, {.drift = true}), -3, 3, {});
  check_breakpoints(*laws::repeat(laws::poly345({}), 1), -1.5, 1.5, {-1, 0, 1});
  check_breakpoints(*laws::repeat(kStart, 2, {.drift = true}), -1, 3.1, {-0.8, 0, 0.2, 1, 1.2, 2, 2.2, 3});
  check_breakpoints(*laws::repeat(kStart, 1.2, {.drift = true}), -0.1, 2, {0, 0.2, 1, 1.2, 1.4});
  check_breakpoints(*laws::repeat(kStart, 0.7, {.drift = true}), -0.1, 1.5, {0, 0.2, 0.7, 0.9, 1.4});
  CHECK(laws::repeat(kStart, 2, {.drift = true})->at(7.5).y == Approx(4.0));
}

TEST_CASE("at its breakpoint every law has the value that holds afterwards, for every delay", "[unit][motionlaws]") {
  for (const double delay : {0.0, 0.1, 0.3, 1.7, 33.3}) {
    for (const auto& law :
         {laws::shift(kStart, delay), laws::sequence({{1.2, kStart}, {0.7, laws::constant(1)}, {1.2, kStart}}, {.t0 = delay}),
          laws::repeat(laws::shift(kStart, 0.1), 1.7, {.t0 = delay}), laws::shift(laws::harmonic_rise({}), delay)}) {
      const auto listed = breakpoints_of(*law, -1, 40);
      REQUIRE(!listed.empty());
      for (const double t : listed) {
        INFO("delay " << delay << ", breakpoint " << t);
        CHECK(law->at(t).ydd == Approx(law->at(t + 1e-7).ydd).margin(1e-4));
      }
    }
  }
}

TEST_CASE("combinations reject impossible arguments", "[unit][motionlaws]") {
  CHECK_THROWS_WITH(laws::sum({}), says("sum") && says("laws are missing"));
  CHECK_THROWS_WITH(laws::product({nullptr}), says("product") && says("null"));
  CHECK_THROWS_WITH(laws::scale(nullptr, 1), says("scale") && says("null"));
  testing::check_words(testing::message_of<ModelError>([&] { laws::shift(nullptr, 1); }), {"shift", "null"});
  CHECK_THROWS_WITH(laws::repeat(laws::ramp(1), 0), says("repeat") && says("period is 0; must be above 0"));
  CHECK_THROWS_WITH(laws::sequence({}), says("sequence") && says("laws are missing"));
  CHECK_THROWS_WITH(laws::sequence({{-1, laws::ramp(1)}}), says("durations is -1; must be above 0"));
}

}  // namespace motionlaws_combine_test
