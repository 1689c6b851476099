// SPDX-License-Identifier: BSD-3-Clause
// A joint of one's own from one function: a nut runs down a screw, counted over many turns, against the closed form.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/author/phi_links.h>
#include <lockstep/lockstep.h>
#include "samples/shared/output.h"

using namespace lockstep;

namespace mine {

/// phi = z - lead * turns. The whole joint: constraint, row, Ct and right side follow from it.
struct ScrewThread {
  double lead;  // m per turn
  static constexpr PhiSpec spec{.counts_turns = true};
  template <class T>
  T operator()(const LockCoords<T>& y) const {
    return y.z - lead / kTwoPi * y.angle_z();
  }
};

/// Free: turning about z of S, advancing along it by the lead per turn.
class Screw final : public PhiLock<ScrewThread> {
 public:
  Screw(std::string name, Marker& p, Marker& s, double lead)
      : PhiLock(std::move(name), p, s, Mask::x | Mask::y | Mask::e1 | Mask::e2, ScrewThread{lead}) {}
  std::string_view type() const override { return "screw"; }
};

}  // namespace mine

int main() {
  const double m = 2, J = 0.004, lead = 0.1, g = 9.81, k = kTwoPi / lead;
  System sys({.gravity = {0, 0, -g}});
  Body& nut = sys.add_body("nut", MassProperties{m, Vec3::Zero(), Vec3(0.003, 0.003, J).asDiagonal()});
  sys.add<mine::Screw>("thread", nut, sys.ground(), pose_at({0, 0, 0}), lead);

  Simulation run(sys, {.integrator = "dop853", .tolerance = 1e-10, .output = 0.02});
  const Table& t =
      run.record({"nut.z", "thread.rz", "thread.force_on_p_world_z", "thread.torque_on_p_world_z", "energy.total"});
  run.run_until(2.0);

  const double a = -m * g / (m + J * k * k);  // z'' in closed form
  double z = 0, turn = 0, force = 0;
  for (std::size_t i = 0; i < t.n_rows(); ++i) {
    const double exact = 0.5 * a * t["t"][i] * t["t"][i];
    z = std::max(z, std::abs(t["nut.z"][i] - exact));
    turn = std::max(turn, std::abs(t["thread.rz"][i] - k * exact));
    force = std::max(force, std::abs(t["thread.force_on_p_world_z"][i] - m * (a + g)));
  }
  write_csv(samples::output("custom_joint.csv"), t);
  write_chart(
      samples::output("custom_joint"),
      {.title = "A nut runs down a screw of 100 mm lead",
       .x_label = "t [s]",
       .panels = {{.y_label = "height [m]", .series = {table_series(t, "t", "nut.z", "nut")}},
                  {.y_label = "angle [rad]", .series = {table_series(t, "t", "thread.rz", "turns counted on")}}}});
  fmt::print("{:.1f} turns; height to {:.1e} m, angle to {:.1e} rad, axial force to {:.1e} N of the closed form\n",
             t.last("thread.rz") / kTwoPi, z, turn, force);
  fmt::print("energy changed by {:.1e} J\n{}, custom_joint.svg, custom_joint.png\n", t.change("energy.total"),
             samples::output("custom_joint.csv"));
  return z < 1e-9 && turn < 1e-7 && force < 1e-8 ? 0 : 1;
}
