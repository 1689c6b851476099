// SPDX-License-Identifier: BSD-3-Clause
// Long time: the energy of the double pendulum, let go from the horizontal, which tumbles without end.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/worst.h"

namespace energy_test {

using namespace lockstep;

namespace {

/// Lowest and highest energy of ten equal parts of the run, J from the start.
struct Part {
  double low = HUGE_VAL, high = -HUGE_VAL;
  double middle() const { return 0.5 * (low + high); }
};

std::vector<Part> parts_of(const std::string& method, double h, long n_steps) {
  const Registry registry = builtin_registry();
  Mechanism m = build_mechanism(read_scene(std::string(paths::kScenes) + "/double_pendulum.json"), registry);
  System& system = system_of(m);
  Dynamics dynamics(system, make_solver(m.run, registry));
  const std::unique_ptr<Integrator> integrator =
      registry.integrators.make(method, Params{}, &registry, "run.integrator");
  State s = system.start();
  dynamics.project(s);
  integrator->begin(dynamics, s);
  const Channel energy = make_channel(system, "energy.total");
  const StepReport report;
  const auto value = [&] { return energy.value(Sample(dynamics, s, report)); };
  const double start = value();
  std::vector<Part> parts(10);
  for (long i = 0; i < n_steps; ++i) {
    integrator->step(dynamics, s, h);
    if (i % 100 != 0) continue;
    Part& part = parts[10 * i / n_steps];
    const double e = value() - start;
    part.low = std::min(part.low, e);
    keep_worst(part.high, e);
  }
  return parts;
}

}  // namespace

TEST_CASE("rattle keeps the energy of the double pendulum bounded over a million steps",
          "[verification][integrators]") {
  struct Way {
    std::string method;
    double h, bound;  // s; J, of 20 J that go to and fro
    long n_steps;
  };
  const auto w = GENERATE(Way{"rattle2", 0.005, 0.06, 1'000'000}, Way{"rattle4", 0.005, 2e-4, 200'000});
  const std::vector<Part> parts = parts_of(w.method, w.h, w.n_steps);
  for (const Part& part : parts) {
    CAPTURE(w.method, part.low, part.high);
    CHECK(part.low > -w.bound);
    CHECK(part.high < w.bound);
  }
  // no trend: what the first half swings about, the second does
  double first = 0, second = 0;
  for (std::size_t i = 0; i < 5; ++i) first += 0.2 * parts[i].middle(), second += 0.2 * parts[5 + i].middle();
  CAPTURE(w.method, first, second);
  CHECK(std::abs(first - second) < 0.25 * w.bound);
}

TEST_CASE("rk4 loses energy of the double pendulum all the time", "[verification][integrators]") {
  const std::vector<Part> parts = parts_of("rk4", 0.005, 50'000);
  for (std::size_t i = 1; i < parts.size(); ++i) CHECK(parts[i].middle() < parts[i - 1].middle());
}

}  // namespace energy_test
