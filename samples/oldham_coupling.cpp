// SPDX-License-Identifier: BSD-3-Clause
// An Oldham coupling of two offset shafts: the disc circles twice a turn, and the output follows exactly.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/lockstep.h>
#include "samples/shared/output.h"

using namespace lockstep;

int main() {
  const double e = 0.02, w = 12;  // offset of the shafts, m; speed, rad/s
  const MassProperties hub{1.0, Vec3::Zero(), 0.01 * Mat3::Identity()};
  System sys;
  Body& input = sys.add_body("input", hub);
  Body& disc = sys.add_body("disc", {0.8, Vec3::Zero(), Vec3(0.002, 0.002, 0.004).asDiagonal()}, {{e, 0, 0}, {}});
  Body& output = sys.add_body("output", hub, {{e, 0, 0}, {}});

  auto& shaft = sys.add<Revolute>("shaft_in", input, sys.ground(), pose_at({0, 0, 0}));
  shaft.drive(Axis::rz, laws::ramp(w));
  sys.add<Revolute>("shaft_out", output, sys.ground(), pose_at({e, 0, 0}));
  // Each hub carries the disc along and lets it slide in one slot: five of six rows, a lock by its mask.
  Marker& center = sys.add_marker("center", disc);
  sys.add<GenericLock>("slot_in", center, sys.add_marker("hub_in", input), mask_from("y z e1 e2 e3"));
  sys.add<GenericLock>("slot_out", center, sys.add_marker("hub_out", output), mask_from("x z e1 e2 e3"));

  Simulation run(sys, {.integrator = "rk4", .step = 1e-3, .output = 5e-3});
  const Table& t = run.record({"shaft_in.rz", "shaft_out.rz", "disc.x", "disc.y", "slot_in.torque_on_p_world_z"});
  run.run_until(kTwoPi / w);

  double turn = 0, circle = 0, couple = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double phi = w * t["t"][i];
    turn = std::max(turn, std::abs(t["shaft_out.rz"][i] - phi));
    circle = std::max(circle, std::hypot(t["disc.x"][i] - e / 2 * (1 + std::cos(2 * phi)),
                                         t["disc.y"][i] - e / 2 * std::sin(2 * phi)));
    couple = std::max(couple, std::abs(t["slot_in.torque_on_p_world_z"][i] - 0.8 * w * w * e * e * std::sin(2 * phi)));
  }
  write_csv(samples::output("oldham_coupling.csv"), t);
  write_chart(samples::output("oldham_coupling"),
              {.title = "Oldham coupling: the disc over one turn of the shafts",
               .x_label = "t [s]",
               .panels = {{.y_label = "disc [m]",
                           .series = {table_series(t, "t", "disc.x", "x"), table_series(t, "t", "disc.y", "y")}},
                          {.y_label = "couple [N m]",
                           .series = {table_series(t, "t", "slot_in.torque_on_p_world_z", "input hub on disc")}}}});
  fmt::print("output follows input to {:.1e} rad; disc on its circle to {:.1e} m; couple exact to {:.1e} N m\n", turn,
             circle, couple);
  fmt::print("{}, oldham_coupling.svg, oldham_coupling.png\n", samples::output("oldham_coupling.csv"));
  return turn < 1e-10 && circle < 1e-10 ? 0 : 1;
}
