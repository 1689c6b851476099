// SPDX-License-Identifier: BSD-3-Clause
// Friction at rest, and impacts that accumulate.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace contact_limits_test {

using namespace lockstep;
using namespace lockstep::stability;

TEST_CASE("friction at rest creeps at the speed given by its smoothing", "[stability][friction]") {
  // pushed by 29/30 of what friction holds: tanh(v / smoothing) = 29/30
  const std::string text = R"({"lockstep": 1, "planar": "off", "gravity": [2.8449, -9.81, 0],
    "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1]}],
    "links": [{"name": "P", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x",
               "friction": {"mu": 0.3, "smoothing_speed": $v}}],
    "run": {"integrator": "radau5", "tolerance": 1e-8, "until": 10, "output": 10, "record": ["b.x", "b.vx"]}})";
  for (const double smoothing : {1e-2, 1e-3, 1e-4}) {
    const Outcome o = outcome_of(filled(text, "$v", smoothing));
    CAPTURE(smoothing, o.error);
    REQUIRE(o.ended());
    CHECK(o.table.last("b.vx") == Approx(smoothing * std::atanh(29.0 / 30.0)).epsilon(1e-3));
    CHECK(o.table.last("b.x") < 10 * smoothing * std::atanh(29.0 / 30.0) * 1.01);
  }
}

TEST_CASE("a ball that bounces ever faster comes to rest at the time of its series", "[stability][impacts]") {
  const std::string text = R"({"lockstep": 1, "gravity": [0, -9.81, 0],
    "bodies": [{"name": "b", "particle": 1, "position": [0, 1, 0]}],
    "links": [{"name": "floor", "type": "point_on_plane", "p": "b", "s": "ground", "at_s": [0, 0, 0], "at_p": [0, 1, 0],
               "axis": "y", "unilateral": {"restitution": $e}}],
    "run": {"integrator": $method, "until": 30, "output": 0.5, "record": ["b.y", "b.vy"]}})";
  for (const double e : {0.0, 0.3, 0.5, 0.8, 0.9})
    for (const char* method :
         {R"("dop853", "tolerance": 1e-9)", R"("rk4", "step": 0.01)", R"("radau5", "tolerance": 1e-8)"}) {
      const Outcome o = outcome_of(filled(filled(text, "$e", e), "$method", method));
      CAPTURE(e, method, o.error);
      REQUIRE(o.ended());
      CHECK(std::abs(o.table.last("b.y")) < 1e-6);
      CHECK(std::abs(o.table.last("b.vy")) < 1e-6);
      CHECK(o.audit.dissipated == Approx(9.81).epsilon(1e-3));
      const double fall = std::sqrt(2 / 9.81), rest = fall * (1 + e) / (1 - e);
      REQUIRE_FALSE(o.audit.instants.empty());
      CHECK(o.audit.instants.back().last == Approx(rest).epsilon(2e-3));
      // speeds down to rest_speed = 1e-3 m/s
      const double impacts = e > 0 ? 1 + std::log(1e-3 / (9.81 * fall)) / std::log(e) : 1;
      CHECK(std::abs(static_cast<double>(o.report.impacts) - impacts) < 2);
    }
}

}  // namespace contact_limits_test
