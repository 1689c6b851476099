// SPDX-License-Identifier: BSD-3-Clause
// Laws that jump: in acceleration (followed), in velocity (an impact, booked), in position (refused by name); and steps
// that end on, before and behind the jump.

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace law_jumps_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

// A slider of 2 kg that follows y(t) along x; the first law for 1 s.
Outcome slide(const std::string& first, const std::string& second, const std::string& run) {
  const std::string text =
      R"({"lockstep": 1, "planar": "off", "bodies": [{"name": "b", "mass": 2, "inertia": [1, 1, 1]}],
    "links": [{"name": "P", "type": "prismatic", "p": "b", "s": "ground", "at": [0, 0, 0], "axis": "x",
               "drive": {"axis": "z", "law": {"type": "sequence", "durations": [1, 10], "laws": [$first, $second]}}}],
    "run": {$run, "until": 2, "output": 0.5, "record": ["b.x", "b.vx"]}})";
  return outcome_of(filled(filled(filled(text, "$first", first), "$second", second), "$run", run));
}

constexpr const char* kRuns[] = {R"("integrator": "dop853", "tolerance": 1e-9)",
                                 R"("integrator": "dopri5", "tolerance": 1e-9)",
                                 R"("integrator": "radau5", "tolerance": 1e-9)",
                                 R"("integrator": "rk4", "step": 0.01)",
                                 R"("integrator": "rk4", "step": 0.03)",
                                 R"("integrator": "semi_implicit_euler", "step": 0.003)",
                                 R"("integrator": "generalized_alpha", "step": 0.003)"};
constexpr const char* kRest = R"({"type": "constant", "value": 0})";

}  // namespace

TEST_CASE("a law that jumps in acceleration is followed by every method", "[stability][laws]") {
  for (const char* run : kRuns) {
    const Outcome o = slide(kRest, R"({"type": "polynomial", "coefficients": [0, 0, 0.5]})", run);
    CAPTURE(run, o.error);
    REQUIRE(o.ended());
    CHECK(o.table.last("b.x") == Approx(0.5).epsilon(1e-3));
    CHECK(o.table.last("b.vx") == Approx(1).epsilon(1e-3));
    CHECK(o.audit.imbalance_share() < 5e-3);
  }
}

TEST_CASE("a law that jumps in velocity is an impact, whose energy is booked", "[stability][laws]") {
  for (const char* run : kRuns) {
    const Outcome o = slide(kRest, R"({"type": "ramp", "slope": 3})", run);
    CAPTURE(run, o.error);
    REQUIRE(o.ended());
    CHECK(o.table.last("b.x") == Approx(3).epsilon(1e-6));
    REQUIRE(o.audit.instants.size() == 1);
    CHECK(o.audit.instants[0].first == Approx(1).epsilon(1e-12));
    CHECK(o.audit.instants[0].energy == Approx(0.5 * 2 * 9).epsilon(1e-6));
  }
}

TEST_CASE("a law that jumps in position is rejected by name, under every stabilisation", "[stability][laws]") {
  for (const char* kind : {"project", "baumgarte", "none"})
    for (const char* run : kRuns) {
      const Outcome o = slide(kRest, R"({"type": "constant", "value": 1})",
                              std::string(run) + R"(, "stabilization": ")" + kind + '"');
      CAPTURE(run, kind, o.error);
      CHECK_FALSE(o.ended());
      CHECK(o.error.find("jumps in position") != std::string::npos);
      CHECK(o.error.find("drive P.z") != std::string::npos);
      CHECK(o.table.n_rows() >= 2);  // what came before is kept
    }
}

TEST_CASE("steps that end on, before and behind a jump agree", "[stability][laws]") {
  const std::string quadratic = R"({"type": "polynomial", "coefficients": [0, 0, 0.5]})";
  for (const char* step : {"0.1", "0.0999999999999", "0.1000000000001", "0.3", "0.7"}) {
    const Outcome o = slide(kRest, quadratic, std::string(R"("integrator": "rk4", "step": )") + step);
    CAPTURE(step, o.error);
    REQUIRE(o.ended());
    CHECK(o.table.last("b.x") == Approx(0.5).epsilon(1e-9));
    CHECK(o.report.steps < 40);
  }
}

}  // namespace law_jumps_test
