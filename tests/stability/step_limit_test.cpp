// SPDX-License-Identifier: BSD-3-Clause
// A stiff spring and a strong damper: every method against the step that its theory allows.
#include <cmath>

#include <lockstep/author/registry.h>
#include <lockstep/scene.h>
#include "framework/tools/sweep/step_limit.h"
#include "tests/support/catch.h"
#include "tests/support/outcome.h"
#include "tests/support/worst.h"

namespace step_limit_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

// A mass of 1 kg that starts 0.1 m off the rest of its spring, and moves for n steps.
std::string mass(const std::string& method, double h, int n, double stiffness, double damping) {
  const std::string text = R"({"lockstep": 1,
    "bodies": [{"name": "m", "particle": 1, "position": [0.1, 0, 0], "velocity": [1, 0, 0]}],
    "markers": [{"name": "wall", "body": "ground", "at": [-100, 0, 0]}, {"name": "hook", "body": "m"}],
    "forces": [{"name": "s", "type": "spring_damper", "p": "hook", "s": "wall", "stiffness": $k, "damping": $c,
                "free_length": 100}],
    "run": {"integrator": $method, "step": $h, "until": $until, "output": $until, "record": ["m.x", "m.vx"]}})";
  return filled(filled(filled(filled(filled(text, "$method", method), "$k", stiffness), "$c", damping), "$h", h),
                "$until", n * h);
}

double largest(const Outcome& o, const char* column) {
  double most = 0;
  for (const double x : o.table[column]) keep_worst(most, std::abs(x));
  return most;
}

double theory(const std::string& method, double stiffness, double damping) {
  const Scene scene = scene_from_text(mass(method, 1e-3, 1, stiffness, damping), "scene.json");
  return step_limit(scene.run.integrator, small_motions(scene, builtin_registry()), 1e-4, 10);
}

}  // namespace

TEST_CASE("explicit methods on a spring: at rest below their limit, away above it", "[stability][step]") {
  struct Limit {
    const char* method;
    double omega_h;
  };
  // rk4: |1 + z + ... + z^4/24| = 1 on the imaginary axis at sqrt 8; the others are leapfrogs
  for (const Limit& limit :
       {Limit{"\"rk4\"", std::sqrt(8.0)}, Limit{"\"semi_implicit_euler\"", 2.0}, Limit{"\"rattle2\"", 2.0}}) {
    constexpr double kOmega = 10;
    CAPTURE(limit.method);
    CHECK(theory(limit.method, kOmega * kOmega, 0) == Approx(limit.omega_h / kOmega).epsilon(0.01));
    const Outcome below = outcome_of(mass(limit.method, 0.98 * limit.omega_h / kOmega, 400, kOmega * kOmega, 0));
    CHECK(below.ended());
    CHECK(largest(below, "m.x") < 2);
    const Outcome above = outcome_of(mass(limit.method, 1.05 * limit.omega_h / kOmega, 25, kOmega * kOmega, 0));
    CHECK((!above.ended() || largest(above, "m.x") > 1));
    CHECK(above.told());
  }
}

TEST_CASE("explicit methods on a damper: the step times the rate has a limit", "[stability][step]") {
  struct Limit {
    const char* method;
    double rate_h;
  };
  for (const Limit& limit : {Limit{"\"rk4\"", 2.785}, Limit{"\"semi_implicit_euler\"", 2.0}}) {
    constexpr double kRate = 100;
    CAPTURE(limit.method);
    CHECK(theory(limit.method, 0, kRate) == Approx(limit.rate_h / kRate).epsilon(0.01));
    const Outcome below = outcome_of(mass(limit.method, 0.97 * limit.rate_h / kRate, 300, 0, kRate));
    CHECK(below.ended());
    CHECK(std::abs(below.table.last("m.vx")) < 1e-3);
    const Outcome above = outcome_of(mass(limit.method, 1.03 * limit.rate_h / kRate, 40, 0, kRate));
    CHECK((!above.ended() || std::abs(above.table.last("m.vx")) > 1.5));
    CHECK(above.told());
  }
  const Outcome rattle = outcome_of(mass("\"rattle2\"", 1e-3, 10, 0, 1));
  CHECK_FALSE(rattle.ended());
  CHECK(rattle.error.find("'s'") != std::string::npos);  // the damper, by name
}

// From rest a first step overshoots as the square of omega h: with a start so far off its rest it is not small.
TEST_CASE("implicit methods have no largest step on a damper, and a stiff spring is bounded or reported",
          "[stability][step]") {
  for (const char* method : {"\"generalized_alpha\"", R"({"type": "radau5", "fixed": true})"})
    for (const double omega_h : {1.0, 10.0, 100.0, 1000.0}) {
      CAPTURE(method, omega_h);
      const Outcome spring = outcome_of(mass(method, 0.01, 200, 1e4 * omega_h * omega_h, 0));
      CHECK(((spring.ended() && largest(spring, "m.x") < 0.15) || spring.told()));
      const Outcome damper = outcome_of(mass(method, 0.01, 200, 0, 100 * omega_h));
      CHECK(damper.ended());
      CHECK(std::abs(damper.table.last("m.vx")) < 1.001);
    }
}

}  // namespace step_limit_test
