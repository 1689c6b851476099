// SPDX-License-Identifier: BSD-3-Clause
// Steps far too large: no method crashes, and none is wrong without a word.

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace large_step_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

// A rod that falls from the horizontal about its hinge, and swings in 1.9 s.
Outcome swing(const std::string& method, double step, double until) {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": $method, "step": $h, "formulation": "omega", "until": $until, "output": $until,
            "record": ["rod.x", "rod.y"]}})";
  return outcome_of(filled(filled(filled(text, "$method", method), "$h", step), "$until", until));
}

}  // namespace

TEST_CASE("a step a thousand times too large ends with an error or is reported", "[stability][step]") {
  for (const char* method : {R"("rk4")", R"("semi_implicit_euler")", R"("rattle2")", R"("rattle4")",
                             R"("generalized_alpha")", R"({"type": "radau5", "fixed": true})",
                             R"({"type": "dopri5", "fixed": true})", R"({"type": "dop853", "fixed": true})"})
    for (const double step : {1.0, 10.0, 100.0}) {
      const Outcome o = swing(method, step, 10 * step);
      CAPTURE(method, step, o.error);
      CHECK(o.told());
      if (!o.ended()) CHECK(o.error.find("step") != std::string::npos);  // what to do
    }
}

TEST_CASE("adaptive methods do not need a step: a largest one beyond the run changes nothing", "[stability][step]") {
  const Outcome reference = swing(R"("dop853")", 0.01, 2);
  for (const char* method : {R"("dop853")", R"("dopri5")", R"("radau5")"}) {
    const Outcome o = swing(method, 1e6, 2);
    CAPTURE(method, o.error);
    REQUIRE(o.ended());
    CHECK(o.table.last("rod.x") == Approx(reference.table.last("rod.x")).margin(1e-4));
  }
}

}  // namespace large_step_test
