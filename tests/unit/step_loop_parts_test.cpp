// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <lockstep/integrators.h>
#include "framework/dynamics/simulate/clock.h"
#include "framework/dynamics/simulate/guard_finder.h"
#include "framework/dynamics/simulate/step_rules.h"
#include "tests/support/catch.h"
#include "tests/support/messages.h"

namespace step_loop_parts_test {

using namespace lockstep;

TEST_CASE("the root finder returns the far end of a bracket within the tolerance", "[unit][dynamics]") {
  struct Case {
    double (*g)(double);
    double root;
  };
  const Case c = GENERATE(Case{[](double t) { return 0.37 - t; }, 0.37},
                          Case{[](double t) { return 0.3 + 0.2 * t - 2 * t * t; }, 0.05 + std::sqrt(0.1525)},
                          Case{[](double t) { return 1 - std::exp(8 * (t - 0.6)); }, 0.6},
                          Case{[](double t) { return t < 0.7 ? 0.7 - t : 20 * (0.7 - t); }, 0.7});
  for (const double tolerance : {1e-6, 1e-9, 4e-16}) {
    int evaluations = 0;
    const auto g = [&](double t) { return ++evaluations, c.g(t); };
    const double t = falling_root(0, c.g(0), 1, c.g(1), tolerance, g);
    CAPTURE(c.root, tolerance, t);
    CHECK(c.g(t) <= 0);
    CHECK(t == Approx(c.root).margin(tolerance + 1e-15));
    CHECK(evaluations <= 16);
  }
}

TEST_CASE("the root finder ends at the ends themselves", "[unit][dynamics]") {
  int evaluations = 0;
  const auto g = [&](double t) { return ++evaluations, 0.5 - t * t; };
  CHECK(falling_root(0, 0.5, 1, 0.0, 0.0, g) == 1);
  CHECK(falling_root(0, 0.0, 1, -0.5, 0.0, g) == 0);  // down before it began
  CHECK(evaluations == 0);
}

TEST_CASE("two equal steps rather than a whole one and a sliver", "[unit][dynamics]") {
  CHECK(step_within(1.0, 0.3, 0) == 0.3);
  CHECK(step_within(1.0, 0.6, 0) == 0.5);
  CHECK(step_within(1.0, 1.2, 0) == 1.0);
  CHECK(step_within(1.0, 1 - 1e-13, 1e-12) == 1.0);
}

TEST_CASE("a step cut short does not reject the longer one advised before", "[unit][dynamics]") {
  CHECK(advised_after(0.1, 0.01, 0.01, 0.05) == 0.1);
  CHECK(advised_after(0.1, 0.01, 0.01, 0.2) == 0.2);
  CHECK(advised_after(0.1, 0.01, 0.005, 0.005) == 0.005);  // rejected on the way
  CHECK(advised_after(0.1, 0.1, 0.1, 0.05) == 0.05);
}

TEST_CASE("the clock outputs its interval, the start and the end", "[unit][dynamics]") {
  System system;
  system.add_particle("stone", 1, {0, 0, 0});
  system.setup();
  Rk4 method;
  const StepLoopOptions options{.step = 0.25, .output = 0.5};
  Clock clock(system, method, options);
  clock.set_end(1.7, 0);
  clock.start(0);
  clock.begin(0, 0);
  CHECK_FALSE(clock.adaptive());
  CHECK(clock.output_due(0));
  clock.note_output(0);
  CHECK(clock.next_output() == 0.5);
  const Clock::Target target = clock.next_target(0, 1.7, HUGE_VAL, 0, false);
  CHECK(target.t == 0.5);
  CHECK_FALSE(target.jump);
  CHECK(clock.next_target(0, 1.7, 0.4, 0, false).t == 0.4);  // an event before it
  CHECK(clock.next_target(0, 1.7, HUGE_VAL, 0, true).t == 1.7);
  CHECK(clock.step_towards(0, target, 0) == 0.25);
  clock.count_step(0.25, {});
  CHECK(clock.step_towards(0.25, target, 0) == 0.25);  // what is left
  CHECK_FALSE(clock.output_due(0.25));
  CHECK(clock.output_due(0.5));
  clock.note_output(0.5);
  CHECK(clock.end_due(1.7));
  clock.note_output(1.7);
  CHECK_FALSE(clock.end_due(1.7));
}

TEST_CASE("the last steps have their mean length and the joints that were touched at their ends", "[unit][dynamics]") {
  LastSteps last;
  last.begin(2);
  CHECK(last.n() == 0);
  CHECK(last.mean() == 0);
  last.touch(1);  // no step was made
  for (int k = 1; k <= 4; ++k) last.add(2 + 0.5 * k);
  last.touch(1), last.touch(4);
  CHECK(last.n() == 4);
  CHECK(last.mean() == 0.5);
  CHECK(last.touched(1) == 1);
  CHECK(last.touched(2) == 0);
  for (long k = 1; k < 2 * LastSteps::kKept; ++k)
    last.add(4 + 0.25 * static_cast<double>(k));  // those before are forgotten
  CHECK(last.n() == LastSteps::kKept);
  CHECK(last.mean() == 0.25);
  CHECK(last.touched(1) == 0);
  last.begin(0);
  CHECK(last.n() == 0);
}

TEST_CASE("a run may have a thousand million steps left by the mean of its last, and no more", "[unit][dynamics]") {
  const std::string method = "any";
  const auto refusal = [&](double end, long n, double h, long max_steps = 0) {
    LastSteps last;
    last.begin(0);
    for (long k = 1; k <= n; ++k) last.add(h * static_cast<double>(k));
    const RunSoFar run{method, true, h * static_cast<double>(n), end, n, max_steps};
    return testing::message_of<StepError>([&] { last.check(run); });
  };
  CHECK(refusal(1e6, LastSteps::kKept, 0.9e-3).find("the rest of the run would take 1.1e+09") != std::string::npos);
  CHECK(refusal(1e6, LastSteps::kKept, 1.1e-3) == "no error");
  CHECK(refusal(1e6, LastSteps::kKept - 1, 1e-9) == "no error");  // too few to say
  CHECK(refusal(HUGE_VAL, LastSteps::kKept, 1e-9) == "no error");
  CHECK(refusal(1, 10, 0.01, 10).find("has used its 10 steps") != std::string::npos);
  CHECK(refusal(1, 10, 0.01, 11) == "no error");
  CHECK(refusal(0.1, 10, 0.01, 10) == "no error");  // it is there
}

}  // namespace step_loop_parts_test
