// SPDX-License-Identifier: BSD-3-Clause
// Far from the origin, very small, very large, and tolerances below round-off.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "tests/support/catch.h"
#include "tests/support/outcome.h"

namespace scale_test {

using namespace lockstep;
using namespace lockstep::stability;

namespace {

constexpr double kA = 0.7, kB = 0.4;  // rods of a double pendulum, in units of its size

// A double pendulum of this size, m, at x from the origin, for two units of its own time sqrt(size/g). Places in its size.
struct Place {
  double x1, y1, x2, y2;
};
Place swing(double size, double x, const std::string& run, Outcome* out = nullptr) {
  const double unit = std::sqrt(size / 9.81);
  const Outcome o = outcome_of(fmt::format(
      R"({{"lockstep": 1, "planar": "off", "gravity": [0, -9.81, 0],
  "bodies": [{{"name": "a", "rod": {{"mass": 1, "from": [{0}, 0, 0], "to": [{1}, 0, 0]}}}},
             {{"name": "b", "rod": {{"mass": 1, "from": [{1}, 0, 0], "to": [{2}, 0, 0]}}}}],
  "links": [{{"name": "A", "type": "revolute", "p": "a", "s": "ground", "at": [{0}, 0, 0]}},
            {{"name": "B", "type": "revolute", "p": "b", "s": "a", "at": [{1}, 0, 0]}}],
  "run": {{{4}, "formulation": "omega", "until": {3}, "output": {3}, "record": ["a.x", "a.y", "b.x", "b.y"]}}}})",
      x, x + kA * size, x + (kA + kB) * size, 2 * unit, run));
  if (out != nullptr) *out = o;
  CAPTURE(size, x, run, o.error);
  if (!o.ended()) return {NAN, NAN, NAN, NAN};
  return {(o.table.last("a.x") - x) / size, o.table.last("a.y") / size, (o.table.last("b.x") - x) / size,
          o.table.last("b.y") / size};
}

double between(const Place& a, const Place& b) {
  return std::max(std::hypot(a.x1 - b.x1, a.y1 - b.y1), std::hypot(a.x2 - b.x2, a.y2 - b.y2));
}

}  // namespace

TEST_CASE("a mechanism of a micrometre and one of a kilometre move alike", "[stability][scale]") {
  const Place metre = swing(1, 0, R"("integrator": "dop853", "tolerance": 1e-9)");
  for (const double size : {1e-6, 1e-3, 1e3}) {
    CAPTURE(size);
    CHECK(between(metre, swing(size, 0, R"("integrator": "dop853", "tolerance": 1e-9)")) < 1e-6);
  }
}

TEST_CASE("a million metres from the origin digits are lost, and no more than there are", "[stability][scale]") {
  const Place near = swing(1, 0, R"("integrator": "dop853", "tolerance": 1e-9)");
  for (const double x : {1e3, 1e6}) {
    CAPTURE(x);
    CHECK(between(near, swing(1, x, R"("integrator": "dop853", "tolerance": 1e-9)")) < 1e-7 + 1e-13 * x);
    CHECK(between(near, swing(1, x, R"("integrator": "rk4", "step": 1e-3)")) < 1e-6 + 1e-12 * x);
  }
}

TEST_CASE("a tolerance below round-off is rejected, or the run ends with the attainable accuracy",
          "[stability][scale]") {
  const Place tight = swing(1, 0, R"("integrator": "dop853", "tolerance": 1e-12)");
  for (const char* tolerance : {"1e-14", "1e-16", "1e-18"}) {
    Outcome o;
    const Place place =
        swing(1, 0, std::string(R"("integrator": "dop853", "max_steps": 200000, "tolerance": )") + tolerance, &o);
    CAPTURE(tolerance, o.error);
    if (o.ended())
      CHECK(between(tight, place) < 1e-9);
    else
      CHECK(o.error.find("tolerance") != std::string::npos);
  }
}

}  // namespace scale_test
