// SPDX-License-Identifier: BSD-3-Clause
// The weak instability of methods without numerical damping, on a stiff spring that turns.
#include <string>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace newmark_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

// A mass that falls from the horizontal on a spring of 1 m: stiff along, soft across.
Outcome swing(double rho, double stiffness, double h) {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "m", "particle": 1, "position": [1, 0, 0]}],
    "markers": [{"name": "pin", "body": "ground"}, {"name": "hook", "body": "m"}],
    "forces": [{"name": "s", "type": "spring_damper", "p": "hook", "s": "pin", "stiffness": $k, "free_length": 1}],
    "run": {"integrator": {"type": "generalized_alpha", "rho_infinity": $rho}, "step": $h, "until": 10, "output": 0.2,
            "record": ["energy.total"]}})";
  return outcome_of(filled(filled(filled(text, "$k", stiffness), "$rho", rho), "$h", h));
}

}  // namespace

TEST_CASE("without numerical damping a rotating stiff spring gains energy, with it it does not",
          "[stability][newmark]") {
  // rho = 1 conserves the energy of linear systems only
  struct Point {
    double stiffness, h;
  };
  for (const auto& [stiffness, h] : {Point{2.15443e7, 0.0233572}, Point{1e8, 0.0143845}}) {
    CAPTURE(stiffness, h);
    const Outcome without = swing(1.0, stiffness, h), with_damping = swing(0.8, stiffness, h);
    CHECK((!without.ended() || without.audit.imbalance_share() > 0.5));
    CHECK(without.told());
    REQUIRE(with_damping.ended());
    CHECK(with_damping.audit.imbalance_share() < 0.01);
  }
  CHECK(swing(1.0, 1e8, 1e-3).audit.imbalance_share() < 1e-4);  // and the gain vanishes with the step
}

}  // namespace newmark_test
