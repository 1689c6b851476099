// SPDX-License-Identifier: BSD-3-Clause
// A swinging rod for a long time: what projection, Baumgarte's terms and nothing make of the drift.
#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace drift_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

Outcome swing(const std::string& stabilization, double until) {
  return outcome_of(filled(filled(R"({"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": "rk4", "step": 0.01, "formulation": "omega", "stabilization": "$kind", "until": $until,
            "output": $until}})",
                                  "$kind", stabilization),
                           "$until", until));
}

}  // namespace

TEST_CASE("a long oscillation: drift is removed, bounded, or grows and is reported", "[stability][drift]") {
  const Outcome projected = swing("project", 100), baumgarte = swing("baumgarte", 100), none = swing("none", 100);
  CHECK(projected.audit.violation < 1e-10);
  CHECK(projected.audit.energy == Audit::Energy::conserved);
  CHECK(baumgarte.audit.violation < 1e-6);
  CHECK(baumgarte.audit.violation > 1e-10);
  CHECK(none.audit.drifted);
  CHECK(none.audit.violation > 3 * swing("none", 50).audit.violation);  // as the square of time
}

TEST_CASE("an hour of oscillations: projection and Baumgarte stabilisation hold, no stabilisation does not",
          "[stability][drift][long]") {
  const Outcome projected = swing("project", 3600), baumgarte = swing("baumgarte", 3600), none = swing("none", 3600);
  CHECK(projected.audit.violation < 1e-10);
  CHECK(projected.audit.energy == Audit::Energy::conserved);
  CHECK(baumgarte.audit.violation < 1e-6);
  CHECK(none.told());
}

}  // namespace drift_test
