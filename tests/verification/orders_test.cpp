// Error against step has the method's slope, on the heavy top: 150 rad/s of spin, a spherical joint, projection every
// step.
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"

using namespace lockstep;

namespace {

/// Largest error of the top's centre over the first 0.2 s, m.
double error_of(const std::string& method, double h, const Table& truth) {
  const SceneRun run = run_scene(std::string(paths::kScenes) + "/heavy_top.json", [&](RunSettings& s) {
    s.integrator = {method};
    if (method.starts_with("dop") || method == "radau5") s.integrator.keys = Value::object({{"fixed", true}});
    s.step = h;
    s.until = 0.2;
  });
  double worst = 0;
  for (const char* c : {"xc", "yc", "zc"})
    for (std::size_t i = 0; i < run.table.n_rows(); ++i)
      worst = std::max(worst, std::abs(run.table[c][i] - truth[c][i]));
  return worst;
}

}  // namespace

TEST_CASE("measured orders on the heavy top are 1, 2, 4, 5 and 8", "[verification][integrators]") {
  struct Method {
    std::string name;
    double order, h;  // h: the coarser step, small enough that the leading term rules, large enough for round-off
  };
  const auto m = GENERATE(Method{"semi_implicit_euler", 1, 1e-4}, Method{"rk4", 4, 1e-3}, Method{"dopri5", 5, 5e-4},
                          Method{"dop853", 8, 5e-3}, Method{"generalized_alpha", 2, 2e-4}, Method{"radau5", 5, 1e-3});
  const Table truth = read_csv(std::string(paths::kSource) + "/tests/verification/data/heavy_top.csv");
  const double coarse = error_of(m.name, m.h, truth), fine = error_of(m.name, m.h / 2, truth);
  const double order = std::log2(coarse / fine);
  CAPTURE(m.name, coarse, fine, order);
  CHECK(std::abs(order - m.order) <= 0.15);
}
