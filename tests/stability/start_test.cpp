// SPDX-License-Identifier: BSD-3-Clause
// Starts that the links do not allow, and links that switch at one instant.

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace start_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

constexpr const char* kRod = R"({"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
    "bodies": [{"name": "rod", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}, "velocity": $v}],
    "links": [{"name": "A", "type": "revolute", "p": "rod", "s": "ground", "at": [0, 0, 0]}],
    "run": {"integrator": "dop853", "assemble": $assemble, "until": 0.5, "output": 0.5, "record": ["rod.vx"]}})";

}  // namespace

TEST_CASE("start velocities against the constraints are removed and reported, or rejected", "[stability][start]") {
  const Outcome taken = outcome_of(filled(filled(kRod, "$v", "[5, 0, 5]"), "$assemble", "true"));
  CHECK(taken.ended());
  CHECK_FALSE(taken.report.findings.empty());
  const Outcome refused = outcome_of(filled(filled(kRod, "$v", "[5, 0, 5]"), "$assemble", "false"));
  CHECK_FALSE(refused.ended());
  CHECK(refused.error.find("5 m/s") != std::string::npos);
  const Outcome right = outcome_of(filled(filled(kRod, "$v", "[0, 0, 0]"), "$assemble", "false"));
  CHECK(right.ended());
}

TEST_CASE("links that switch at one instant do not depend on the order of the events", "[stability][start]") {
  // a bar on two pins; at 0.3 s one goes and another comes
  const std::string text = R"({"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
    "bodies": [{"name": "bar", "rod": {"mass": 1, "from": [0, 0, 0], "to": [1, 0, 0]}}],
    "links": [{"name": "left", "type": "revolute", "p": "bar", "s": "ground", "at": [0, 0, 0]},
              {"name": "right", "type": "revolute", "p": "bar", "s": "ground", "at": [1, 0, 0]},
              {"name": "middle", "type": "revolute", "p": "bar", "s": "ground", "at": [0.4, 0, 0], "active": false}],
    "events": [$events],
    "run": {"integrator": "dop853", "tolerance": 1e-10, "until": 1, "output": 0.5, "record": ["bar.x", "bar.y"]}})";
  const std::string a = R"({"name": "a", "at": 0.3, "deactivate": ["left"]})",
                    b = R"({"name": "b", "at": 0.3, "deactivate": ["right"], "activate": ["middle"]})",
                    both = R"({"name": "c", "at": 0.3, "deactivate": ["left", "right"], "activate": ["middle"]})";
  const Outcome one = outcome_of(filled(text, "$events", a + "," + b)),
                other = outcome_of(filled(text, "$events", b + "," + a)),
                together = outcome_of(filled(text, "$events", both));
  REQUIRE(one.ended());
  REQUIRE(other.ended());
  REQUIRE(together.ended());
  for (const Outcome* o : {&other, &together}) {
    CHECK(o->table.last("bar.x") == Approx(one.table.last("bar.x")).margin(1e-9));
    CHECK(o->table.last("bar.y") == Approx(one.table.last("bar.y")).margin(1e-9));
  }
  CHECK(one.table.last("bar.y") < -0.01);  // it falls about the middle pin
}

}  // namespace start_test
