// SPDX-License-Identifier: BSD-3-Clause
// Free bodies of awkward inertia: nearly flat, nearly spherical, and the turn of the tennis racket.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace inertia_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

Outcome tumble(const std::string& inertia, const std::string& method, double until) {
  const std::string text = R"({"lockstep": 1,
    "bodies": [{"name": "b", "mass": 1, "inertia": $J, "omega_body": [1e-3, 1, 1e-3]}],
    "run": {"integrator": $method, "until": $until, "output": 0.05,
            "record": ["energy.total", "b.omega_body_y", "angular_momentum.x", "angular_momentum.y",
                       "angular_momentum.z"]}})";
  return outcome_of(filled(filled(filled(text, "$J", inertia), "$method", method), "$until", until));
}

constexpr const char* kTight = R"("dop853", "tolerance": 1e-11)";

}  // namespace

TEST_CASE("a nearly flat, a nearly spherical and a thin body keep energy and angular momentum",
          "[stability][inertia]") {
  for (const char* inertia : {"[1, 1, 1.999999999]", "[1, 1.000000001, 0.999999999]", "[1, 1, 1e-7]", "[1, 2, 3]"}) {
    const Outcome o = tumble(inertia, kTight, 100);
    CAPTURE(inertia, o.error);
    REQUIRE(o.ended());
    CHECK(std::abs(o.table.change("energy.total")) < 1e-9);
    for (const char* axis : {"angular_momentum.x", "angular_momentum.y", "angular_momentum.z"})
      CHECK(std::abs(o.table.change(axis)) < 1e-9);
  }
}

TEST_CASE("an impossible inertia is rejected by name", "[stability][inertia]") {
  const Outcome o = tumble("[1, 1, 2.1]", kTight, 1);
  CHECK_FALSE(o.ended());
  CHECK(o.error.find("'b'") != std::string::npos);
}

TEST_CASE("the tennis racket flips at the times of elliptic functions, with every method", "[stability][inertia]") {
  // The first turn of omega_y through zero is a quarter of the period 4 K(k)/p, less the start's phase. Found here by
  // Euler's equations in the energy integral; the interval between two turns is 2 K(k)/p.
  constexpr double A = 1, B = 2, C = 3, w1 = 1e-3, w2 = 1, w3 = 1e-3;
  const double T2 = A * w1 * w1 + B * w2 * w2 + C * w3 * w3, L2 = A * A * w1 * w1 + B * B * w2 * w2 + C * C * w3 * w3;
  const double a = (C - B) * (L2 - A * T2), b = (B - A) * (C * T2 - L2);  // Landau and Lifshitz, 37.8 and 37.9
  const double larger = std::max(a, b), smaller = std::min(a, b);
  const double p = std::sqrt(larger / (A * B * C)), k = std::sqrt(smaller / larger);
  const double interval = 2 * std::comp_ellint_1(k) / p;
  for (const char* method :
       {R"("dop853", "tolerance": 1e-11)", R"("radau5", "tolerance": 1e-9)", R"("rk4", "step": 2e-3)",
        R"("dopri5", "tolerance": 1e-9)", R"("generalized_alpha", "step": 2e-3)"}) {
    const Outcome o = tumble("[1, 2, 3]", method, 60);
    CAPTURE(method, o.error);
    REQUIRE(o.ended());
    const auto &t = o.table["t"], &w = o.table["b.omega_body_y"];
    std::vector<double> turns;
    for (std::size_t i = 1; i < t.size(); ++i)
      if (w[i - 1] * w[i] < 0) turns.push_back(t[i - 1] + (t[i] - t[i - 1]) * w[i - 1] / (w[i - 1] - w[i]));
    REQUIRE(turns.size() >= 2);
    CHECK(turns[1] - turns[0] == Approx(interval).epsilon(2e-3));
  }
}

}  // namespace inertia_test
