// SPDX-License-Identifier: BSD-3-Clause
// Baumgarte's gain times the step against the theory's limits (2.16).
#include "tests/support/catch.h"
#include "tests/support/stability_probe.h"

namespace lockstep::stability {

TEST_CASE("a violation decays below the limit and grows above it", "[stability][baumgarte]") {
  for (const Limit& limit : kLimits) {
    INFO(limit.method);
    CHECK(violation_ratio(limit, 0.95 * limit.gain_h, 200) < 1e-3);
    CHECK(violation_ratio(limit, 1.05 * limit.gain_h, 200) > 1e3);
  }
}

TEST_CASE("at critical damping the violation follows (2.15)", "[stability][baumgarte]") {
  // C(t) = C0 (1 + a t) exp(-a t), Cd0 = 0; rk4 at a h = 0.05, a t = 5
  const double a_t = 5.0;
  CHECK(violation_ratio(kLimits[0], 0.05, 100) == Approx((1 + a_t) * std::exp(-a_t)).epsilon(1e-5));
}

TEST_CASE("a swinging rod is accurate, inaccurate and fails as in the map", "[stability][baumgarte]") {
  const Vec3 truth = swung();
  for (const Limit& limit : kLimits) {
    INFO(limit.method);
    CHECK(swing(limit, 0.5 * limit.gain_h, 1e-3, truth) == kWorks);
    CHECK(swing(limit, 1.05 * limit.gain_h, 1e-3, truth) == kFails);
    CHECK(swing(limit, 1.5 * limit.gain_h, 0.02, truth) == kFails);
  }
  CHECK(swing(kLimits[1], 0.4, 0.02, truth) == kInaccurate);
  CHECK(swing(kLimits[0], 0.4, 0.02, truth) == kWorks);
}

}  // namespace lockstep::stability
