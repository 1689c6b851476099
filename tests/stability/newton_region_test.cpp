// SPDX-License-Identifier: BSD-3-Clause
// How far implicit methods may go in a step before Newton's method no longer finds its end: a rod on a stiff spring that
// turns fast.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace newton_region_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

constexpr double kRate = 10;  // rad/s

// A rod that turns about its hinge by `turn` in each step, twenty times; a spring at its end is as stiff as it turns.
Outcome turning(const std::string& method, double turn, double stiffness) {
  const double h = turn / kRate;
  const std::string text = R"({"lockstep": 1,
    "bodies": [{"name": "rod", "rod": {"mass": 3, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "markers": [{"name": "post", "body": "ground", "at": [2, 0, 0]}, {"name": "end", "body": "rod", "at": [0.5, 0, 0]}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0],
               "start": {"velocity": {"rz": 10}}}],
    "forces": [{"name": "s", "type": "spring_damper", "p": "end", "s": "post", "stiffness": $k, "free_length": 1}],
    "run": {"integrator": $method, "step": $h, "formulation": "omega", "until": $until, "output": $until,
            "record": ["A.rz", "A.rz_d"]}})";
  return outcome_of(
      filled(filled(filled(filled(text, "$method", method), "$h", h), "$until", 20 * h), "$k", stiffness));
}

}  // namespace

TEST_CASE(
    "implicit methods: a hundredth of a revolution per step converges, a larger one converges, fails or is reported",
    "[stability][step]") {
  for (const char* method : {R"("generalized_alpha")", R"({"type": "radau5", "fixed": true})"})
    for (const double stiffness : {0.0, 1.0, 100.0}) {
      for (const double turn : {0.01, 0.1}) {
        const Outcome o = turning(method, turn, stiffness);
        CAPTURE(method, stiffness, turn, o.error);
        if (turn > 0.05 && method[0] == '{' && !o.ended()) {  // all stages of a step at once reach less far
          CHECK(o.error.find("Newton's method did not converge") != std::string::npos);
          continue;
        }
        REQUIRE(o.ended());
        CHECK(o.audit.violation < 1e-9);
        if (stiffness == 0) CHECK(o.table.last("A.rz") == Approx(20 * turn).epsilon(turn * turn));
      }
      for (const double turn : {1.0, 2.0, 3.0, 6.0, 20.0}) {
        const Outcome o = turning(method, turn, stiffness);
        CAPTURE(method, stiffness, turn, o.error, o.told());
        const bool right = o.ended() && stiffness == 0 && std::abs(o.table.last("A.rz") - 20 * turn) < 1e-2 * turn;
        CHECK((right || o.told()));
        if (!o.ended()) CHECK(o.error.find("step") != std::string::npos);  // what to do
      }
    }
}

}  // namespace newton_region_test
