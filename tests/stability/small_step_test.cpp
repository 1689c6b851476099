// SPDX-License-Identifier: BSD-3-Clause
// Implicit methods at very small steps: the scaling of their linear systems keeps forces and motion.

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace small_step_test {

using namespace lockstep;
using namespace lockstep::stability;

TEST_CASE("generalized_alpha keeps reactions at steps down to 1e-8 s", "[stability][step]") {
  // a rod hung by a hinge at its end, let go from the horizontal: a quarter of its weight on the hinge
  const std::string text = R"({"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0], "axial_inertia": 1e-4}}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": "generalized_alpha", "step": $h, "formulation": "omega", "until": $until, "output": $until,
            "record": ["rod.vy", {"F": "A.force_on_p_world_y"}]}})";
  for (const double h : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    CAPTURE(h);
    const Outcome o = outcome_of(filled(filled(text, "$h", h), "$until", 20 * h));
    REQUIRE(o.ended());
    const double t = 20 * h;
    CHECK(o.table.last("F") == Approx(9.81 / 4).epsilon(1e-6 + 100 * t * t));
    CHECK(o.table.last("rod.vy") == Approx(-0.75 * 9.81 * t).epsilon(1e-6 + 100 * t * t));
    CHECK(o.audit.violation < 1e-9);
  }
}

}  // namespace small_step_test
