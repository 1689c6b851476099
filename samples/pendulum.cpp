// SPDX-License-Identifier: BSD-3-Clause
// A rod swings from the horizontal: its period against the elliptic integral, its energy against the start.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/lockstep.h>
#include "samples/shared/output.h"

using namespace lockstep;

int main() {
  System sys({.gravity = {0, -9.81, 0}});
  Body& bar = sys.add_body("rod", shapes::rod(1.0, {0, 0, 0}, {1, 0, 0}));
  sys.add<Revolute>("hinge", bar, sys.ground(), pose_at({0, 0, 0}));

  Simulation run(sys, {.integrator = "dop853", .tolerance = 1e-10, .output = 0.01});
  const Table& table = run.record({"rod.angle_z", "hinge.force_on_p_world_x", "hinge.force_on_p_world_y", "energy.total"});

  // The rod is back at rest where it began: its angular velocity about z (of the only slot) falls through zero again.
  Event back{.name = "back at the start"};
  back.value = [](const Sample& now) { return now.inputs().slot(0).w[2]; };
  back.crossing = Event::Crossing::falling;
  back.stop = true;
  run.add_event(back);
  run.run_until(10.0);
  const double period = run.state().t;

  // Exact: T = 4 K(k) / w with k = sin(pi/4), K by the arithmetic-geometric mean; w^2 = m g l / I, l = 1/2.
  const double J = bar.mass.J(2, 2) + 0.25, w = std::sqrt(9.81 * 0.5 / J);
  double a = 1.0, b = std::sqrt(0.5);
  while (std::abs(a - b) > 1e-15) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b), a = mean;
  }
  const double exact = 4.0 * (kPi / (2.0 * a)) / w;

  const std::string csv = samples::output("pendulum.csv");
  write_csv(csv, table);
  write_chart(
      samples::output("pendulum"),
      {.title = "A rod swings from the horizontal",
       .x_label = "t [s]",
       .panels = {{.y_label = "angle [rad]", .series = {table_series(table, "t", "rod.angle_z", "angle of the rod")}},
                  {.y_label = "force on the rod [N]",
                   .series = {table_series(table, "t", "hinge.force_on_p_world_x", "x"),
                              table_series(table, "t", "hinge.force_on_p_world_y", "y")}}}});
  fmt::print("period  {:.12f} s   exact {:.12f} s   difference {:.1e} s\n", period, exact, period - exact);
  fmt::print("energy changed by {:.1e} J over one period\n", table.change("energy.total"));
  fmt::print("{}, pendulum.svg, pendulum.png\n", csv);
  return std::abs(period - exact) < 1e-8 ? 0 : 1;
}
