// SPDX-License-Identifier: BSD-3-Clause
// Andrews' squeezing mechanism from its scene file: two integrators, and both against the published end.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/lockstep.h>
#include "samples/shared/output.h"
#include "samples/shared/paths.h"

using namespace lockstep;

namespace {

struct Run {
  Table table;
  long evaluations = 0;
};

Run run_with(const std::string& integrator, const Registry& registry) {
  Mechanism mechanism = read_mechanism(std::string(paths::kScenes) + "/andrews_ivp.json", registry);
  mechanism.run.integrator = {integrator};
  Simulation run(std::move(mechanism));
  run.run();
  return {run.table(), run.dynamics().work().evaluations};
}

}  // namespace

int main() {
  const Registry registry = builtin_registry();
  // Test Set for IVP Solvers, t = 0.03 s: good for 9 to 10 digits.
  const double beta = 15.81077119629904, gamma = 0.04082224013073101;
  double worst = 0;
  Run last;
  for (const char* integrator : {"dopri5", "dop853"}) {
    last = run_with(integrator, registry);
    const double error = std::max(std::abs(last.table.last("beta") - beta), std::abs(last.table.last("gamma") - gamma));
    fmt::print("{:8} {:7} evaluations   beta {:.12f}   gamma {:.12f}   off the published end by {:.1e} rad\n",
               integrator, last.evaluations, last.table.last("beta"), last.table.last("gamma"), error);
    worst = std::max(worst, error);
  }
  const Table& t = last.table;
  write_csv(samples::output("andrews.csv"), t);
  write_chart(
      samples::output("andrews"),
      {.title = "Andrews' squeezing mechanism",
       .x_label = "t [s]",
       .panels = {{.y_label = "angle [rad]", .series = {table_series(t, "t", "beta", "beta (crank)")}},
                  {.y_label = "angle [rad]",
                   .series = {table_series(t, "t", "gamma", "gamma"), table_series(t, "t", "phi", "phi"),
                              table_series(t, "t", "delta", "delta"), table_series(t, "t", "epsilon", "epsilon")}}}});
  fmt::print("{}, andrews.svg, andrews.png\n", samples::output("andrews.csv"));
  return worst < 5e-9 ? 0 : 1;
}
