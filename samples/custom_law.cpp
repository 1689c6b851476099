// SPDX-License-Identifier: BSD-3-Clause
// A motion law of one's own: written as a plain function, its derivatives are exact; the drive force proves it.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/lockstep.h>
#include "samples/shared/output.h"

using namespace lockstep;

int main() {
  const double m = 3, g = 9.81;
  // Any function of t that is written for any number: lockstep evaluates it on jets, value and two derivatives at once.
  const LawPtr<MotionLaw> lift = laws::law([](auto t) { return 0.1 * (1.0 - exp(-2.0 * t)) * sin(5.0 * t); });

  System sys({.gravity = {0, 0, -g}});
  Body& slider = sys.add_body("slider", shapes::box(m, {0.1, 0.1, 0.1}));
  auto& guide = sys.add<Prismatic>("guide", slider, sys.ground(), pose_at({0, 0, 0}));
  guide.drive(Axis::z, lift);

  Simulation run(sys, {.integrator = "dop853", .tolerance = 1e-10, .output = 0.01});
  const Table& t = run.record({"slider.z", "slider.az", "guide.drive.force_on_p_link_z", "guide.drive.work", "energy.total"});
  run.run_until(3.0);

  double worst = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i)
    worst = std::max(worst, std::abs(t["guide.drive.force_on_p_link_z"][i] - m * (lift->at(t["t"][i]).ydd + g)));
  write_csv(samples::output("custom_law.csv"), t);
  write_chart(samples::output("custom_law"),
              {.title = "A slider lifted by a law of one's own",
               .x_label = "t [s]",
               .panels = {{.y_label = "height [m]", .series = {table_series(t, "t", "slider.z", "height")}},
                          {.y_label = "force [N]",
                           .series = {table_series(t, "t", "guide.drive.force_on_p_link_z", "force of the drive")}}}});
  const double gap = t.change("energy.total") - t.change("guide.drive.work");
  fmt::print("drive force = m (s'' + g) to {:.1e} N\n", worst);
  fmt::print("energy change {:.9f} J, work of the drive {:.9f} J, gap {:.1e} J\n", t.change("energy.total"),
             t.change("guide.drive.work"), gap);
  fmt::print("{}, custom_law.svg, custom_law.png\n", samples::output("custom_law.csv"));
  return worst < 1e-8 && std::abs(gap) < 1e-8 ? 0 : 1;
}
