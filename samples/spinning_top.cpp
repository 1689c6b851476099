// SPDX-License-Identifier: BSD-3-Clause
// A heavy top in steady precession: fast spin, slow drift, and a height that must not change.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/lockstep.h>
#include "samples/shared/output.h"

using namespace lockstep;

int main() {
  // Steady: I1 W^2 cos(th) - I3 w3 W + m g l = 0 gives the spin w3 for a precession W at the nutation angle th.
  const double m = 5, l = 0.3, I1 = 0.8, I3 = 0.05, g = 9.81, th = kPi / 3, W = 1.5;
  const double w3 = (I1 * W * W * std::cos(th) + m * g * l) / (I3 * W);

  System sys({.gravity = {0, 0, -g}});
  MassProperties mass{m, {0, 0, l}, Vec3(I1 - m * l * l, I1 - m * l * l, I3).asDiagonal()};
  Body& top = sys.add_body("top", mass, {{0, 0, 0}, axis_angle(Vec3::UnitX(), th)});
  top.start.w = {0, W * std::sin(th), w3};
  sys.add<Spherical>("tip", top, sys.ground(), pose_at({0, 0, 0}));

  Simulation run(sys, {.integrator = "dop853", .tolerance = 1e-10, .output = 0.02});
  const Table& t = run.record({"top.center_x", "top.center_y", "top.center_z", "energy.total", "angular_momentum.z"});
  run.run_until(5.0);

  double height = 0, path = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double phase = W * t["t"][i], r = l * std::sin(th);
    height = std::max(height, std::abs(t["top.center_z"][i] - l * std::cos(th)));
    path = std::max(path,
                    std::hypot(t["top.center_x"][i] - r * std::sin(phase), t["top.center_y"][i] + r * std::cos(phase)));
  }
  write_csv(samples::output("spinning_top.csv"), t);
  write_chart(samples::output("spinning_top"),
              {.title = "A top in steady precession: 208 rad/s of spin, 1.5 rad/s of drift",
               .x_label = "x of the mass centre [m]",
               .panels = {{.y_label = "y of the mass centre [m]",
                           .series = {table_series(t, "top.center_x", "top.center_y", "path over 5 s")}}}});
  fmt::print("spin {:.1f} rad/s, precession {:.2f} rad/s\n", w3, W);
  fmt::print("height kept to {:.1e} m, path on its circle to {:.1e} m\n", height, path);
  fmt::print("energy changed by {:.1e} J, vertical angular momentum by {:.1e} kg m^2/s\n", t.change("energy.total"),
             t.change("angular_momentum.z"));
  fmt::print("{}, spinning_top.svg, spinning_top.png\n", samples::output("spinning_top.csv"));
  return height < 1e-8 && path < 1e-7 ? 0 : 1;
}
