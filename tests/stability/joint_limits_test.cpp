// SPDX-License-Identifier: BSD-3-Clause
// Joints near the positions where their own coordinates fail: a universal joint near its gimbal pose, homokinetic rows
// near a half turn.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"
#include "tests/support/worst.h"

namespace joint_limits_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

// Two shafts in hinges whose axes enclose this angle, joined in one point; the first is driven at 1 rad/s.
Outcome shafts(const std::string& type, double angle) {
  const double x = std::sin(angle), z = std::cos(angle);
  const std::string text = fmt::format(
      R"({{"lockstep": 1, "planar": "off",
  "bodies": [{{"name": "in", "mass": 1, "inertia": [0.1, 0.1, 0.1], "position": [0, 0, -1]}},
             {{"name": "out", "mass": 1, "inertia": [0.1, 0.1, 0.1], "position": [{0}, 0, {1}]}}],
  "markers": [{{"name": "p", "body": "out", "world_at": [0, 0, 0], "world_orientation": {{"axis": "y", "angle": {2}}}}},
              {{"name": "s", "body": "in", "world_at": [0, 0, 0]}}],
  "links": [{{"name": "A", "type": "revolute", "p": "in", "s": "ground", "at": [0, 0, -1],
              "drive": {{"axis": "rz", "law": {{"type": "ramp", "slope": 1}}}}}},
            {{"name": "B", "type": "cylindrical", "p": "out", "s": "ground", "at": [{0}, 0, {1}], "axis": [{0}, 0, {1}]}},
            {{"name": "J", "type": "{3}", "p": "p", "s": "s"}}],
  "run": {{"integrator": "dop853", "tolerance": 1e-9, "until": 3, "output": 0.05, "max_steps": 20000,
           "record": [{{"w": "out.omega_world_x"}}, {{"wz": "out.omega_world_z"}}, "violation"]}}}})",
      x, z, angle, type);
  return outcome_of(text);
}

}  // namespace

TEST_CASE("a universal joint gives the rates of Hooke's formula up to its gimbal pose", "[stability][joints]") {
  for (const double from_gimbal : {0.5, 0.1, 0.01, 1e-3}) {
    const double angle = 0.5 * 3.14159265358979323846 - from_gimbal;
    const Outcome o = shafts("universal", angle);
    CAPTURE(from_gimbal, o.error);
    if (!o.ended()) {  // it says so, with the time or the link
      CHECK(o.error.find("t = ") != std::string::npos);
      continue;
    }
    double most = 0;
    for (std::size_t i = 0; i < o.table.n_rows(); ++i) keep_worst(most, std::hypot(o.table["w"][i], o.table["wz"][i]));
    // rates lie between cos(angle) and 1/cos(angle)
    CHECK(most < (1 + 1e-6) / std::cos(angle));
    CHECK(o.audit.violation < 1e-8);
  }
}

TEST_CASE("homokinetic constraints rotate both shafts equally up to nearly half a revolution", "[stability][joints]") {
  for (const double from_half : {1.0, 0.3, 0.1, 0.03, 0.01}) {
    const double angle = 3.14159265358979323846 - from_half;
    const Outcome o = shafts("homokinetic", angle);
    CAPTURE(from_half, o.error);
    if (!o.ended()) {
      CHECK(o.error.find("'J'") != std::string::npos);
      continue;
    }
    for (std::size_t i = 0; i < o.table.n_rows(); ++i)
      CHECK(std::hypot(o.table["w"][i], o.table["wz"][i]) == Approx(1).epsilon(1e-6));
  }
}

}  // namespace joint_limits_test
