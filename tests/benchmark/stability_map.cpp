// SPDX-License-Identifier: BSD-3-Clause
// Baumgarte's gain times step, against the step: where a swinging rod is accurate, inaccurate, or fails; CSV and picture.
#include <fstream>

#include <spdlog/fmt/fmt.h>

#include "framework/tools/charts/chart_grid.h"
#include "samples/shared/output.h"
#include "tests/support/stability_probe.h"

using namespace lockstep;
using namespace lockstep::stability;

namespace {

std::vector<double> spaced(double low, double high, int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(low * std::pow(high / low, static_cast<double>(i) / (n - 1)));
  return x;
}

}  // namespace

int main() {
  const std::vector<double> gain_h = spaced(0.05, 5, 33), steps = spaced(1e-3, 0.1, 17);
  const Vec3 reference = swung();
  constexpr const char* kWords[] = {"accurate", "inaccurate", "failed"};
  const std::string file = samples::output("stability_map.csv");
  std::ofstream csv(file);
  csv << "method,gain times step,step [s],verdict\n";
  std::vector<MapSpec> maps;
  for (const Limit& limit : kLimits) {
    MapSpec map;
    map.title = fmt::format("{}, theory (2.16): {:.3f}", limit.method, limit.gain_h);
    map.x_label = "gain times step, alpha h = beta h", map.y_label = "step h [s]";
    map.x = gain_h, map.y = steps;
    map.log_x = map.log_y = true;
    map.kinds = {{"accurate", "#6fbfae"}, {"inaccurate", "#f2c14e"}, {"failed", "#cf5b50"}};
    long counts[3] = {};
    for (const double h : steps)
      for (const double g : gain_h) {
        const Verdict verdict = swing(limit, g, h, reference);
        map.cells.push_back(verdict);
        ++counts[verdict];
        csv << fmt::format("{},{:.4g},{:.4g},{}\n", limit.method, g, h, kWords[verdict]);
      }
    map.curves = {
        {"theory", {limit.gain_h, limit.gain_h}, {steps.front() * 0.9, steps.back() * 1.1}, SeriesStyle::lines}};
    fmt::print("{:20} accurate {:4}, inaccurate {:4}, failed {:4} of {} runs\n", limit.method, counts[kWorks],
               counts[kInaccurate], counts[kFails], gain_h.size() * steps.size());
    maps.push_back(std::move(map));
  }
  write_map_grid(
      samples::output("stability_map"),
      {.title = "Baumgarte stabilisation: a rod of 1 m swings for 2 s; accurate: within 1 cm of the reference solution",
       .n_columns = 1,
       .maps = maps,
       .curve_label = "theory (2.16)",
       .width = 1000,
       .map_height = 430});
  fmt::print("{}, stability_map.svg, stability_map.png\n", file);
}
