#include "framework/tools/record/turn_counter.h"

#include "tests/support/catch.h"
#include "tests/support/worst.h"

namespace turn_counter_test {

using namespace lockstep;

namespace {

double wrapped(double a) { return std::atan2(std::sin(a), std::cos(a)); }

}  // namespace

TEST_CASE("before the first accepted value an angle is in the half-open turn around zero", "[unit][record]") {
  const TurnCounter turns;
  CHECK(turns.at(3.0, 0, 0) == 3.0);
  CHECK(turns.at(4.0, 0, 0) == Approx(4.0 - kTwoPi));
  CHECK(turns.at(-kPi, 0, 0) == Approx(kPi));
  CHECK(turns.at(kPi, 0, 0) == Approx(kPi));
}

TEST_CASE("a turn counter follows an angle through full turns, both ways", "[unit][record]") {
  TurnCounter turns;
  double worst = 0;
  const auto angle = [](double t) { return 20 * std::sin(t) + 0.3; };  // six turns to and fro
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.02 * i;
    turns.accept(wrapped(angle(t)), t, 20 * std::cos(t));
    keep_worst(worst, std::abs(turns.at(wrapped(angle(t)), t, 20 * std::cos(t)) - angle(t)));
  }
  CHECK(worst < 1e-12);
}

TEST_CASE("the rates lead over several turns a step, and back inside a step", "[unit][record]") {
  TurnCounter turns;
  const auto angle = [](double t) { return 30 * t + 0.2 * t * t; };
  const auto rate = [](double t) { return 30 + 0.4 * t; };
  for (int i = 0; i <= 10; ++i) turns.accept(wrapped(angle(i)), i, rate(i));  // almost five turns a step
  CHECK(turns.at(wrapped(angle(10)), 10, rate(10)) == Approx(angle(10)));
  for (double t : {9.3, 10.0, 10.9}) CHECK(turns.at(wrapped(angle(t)), t, rate(t)) == Approx(angle(t)));
}

TEST_CASE("the mean of both rates leads where a step begins at rest and ends fast", "[unit][record]") {
  TurnCounter turns;
  for (int i = 0; i <= 6; ++i) {  // 10 t^2: up to 110 rad a step
    const double angle = 10.0 * i * i, rate = 20.0 * i;
    turns.accept(wrapped(angle), i, rate);
    CHECK(turns.at(wrapped(angle), i, rate) == Approx(angle));
  }
}

TEST_CASE("without a rate the nearest branch is taken", "[unit][record]") {
  TurnCounter turns;
  const double none = std::nan("");
  turns.accept(3.0, 0, none);
  CHECK(turns.at(-3.0, 0.1, none) == Approx(kTwoPi - 3.0));
  turns.restart();
  CHECK(turns.at(-3.0, 0.1, none) == -3.0);
}

}  // namespace turn_counter_test
