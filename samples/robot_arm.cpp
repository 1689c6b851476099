// SPDX-License-Identifier: BSD-3-Clause
// A six-axis arm whose tool follows a trajectory; the joint angles are read and fed back as laws: the same motion.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include <lockstep/integrators.h>
#include <lockstep/lockstep.h>
#include "samples/shared/output.h"
#include "samples/shared/robot_arm.h"
#include "samples/shared/sampled_law.h"

using namespace lockstep;

namespace {

constexpr double kStep = 2.5e-3, kEnd = 2.0;

Table run(samples::Arm& arm) {
  std::vector<Request> wanted{"tool.x", "tool.y", "tool.z", "tool.cardan_1", "tool.cardan_2", "tool.cardan_3"};
  for (int k = 1; k <= 6; ++k)
    for (const char* what : {"rz", "rz_d", "rz_dd"}) wanted.push_back(fmt::format("J{}.{}", k, what));
  Recorder recorder(arm.sys, wanted);
  Dynamics dynamics(arm.sys, std::make_unique<SchurSolver>());
  State start = arm.sys.start();
  assemble(dynamics, start);
  StepLoop simulation(dynamics, std::make_unique<Rk4>(), {.step = kStep, .output = kStep});
  simulation.set_state(start);
  simulation.add_observer(recorder);
  simulation.run_until(kEnd);
  return recorder.table();
}

}  // namespace

int main() {
  const std::array<double, 6> q0{0.2, -0.4, 1.4, 0.2, 0.75, -0.2};
  // First the tool is led: C and Ct carry the law of its pose, Qc its acceleration; the joints follow.
  samples::Arm led = samples::make_arm(q0);
  const Pose home = led.tool->body->home * led.tool->local;
  auto& lead = led.sys.add<Fixed>("lead", *led.tool, led.sys.add_marker("station", led.sys.ground(), home));
  lead.move(laws::translation([](auto t) {
    return std::array{0.12 * sin(1.5 * t), 0.15 * (1.0 - cos(1.5 * t)), 0.08 * sin(3.0 * t) * t};
  }));
  lead.turn(laws::axis_rotation({1, 2, -1}, laws::law([](auto t) { return 0.3 * sin(2.0 * t); })));
  const Table a = run(led);

  // Then every joint is driven by what it did, and nobody holds the tool.
  samples::Arm driven = samples::make_arm(q0);
  for (std::size_t k = 0; k < 6; ++k) {
    const std::string name = fmt::format("J{}.rz", k + 1);
    std::vector<LawValue> samples;
    for (std::size_t i = 0; i < a.n_rows(); ++i) samples.push_back({a[name][i], a[name + "_d"][i], a[name + "_dd"][i]});
    driven.joints[k]->drive(Axis::rz, std::make_shared<samples::Sampled>(std::move(samples), kStep));
  }
  const Table b = run(driven);

  double position = 0, turn = 0;
  for (std::size_t i = 0; i < a.n_rows(); ++i) {
    for (const char* c : {"tool.x", "tool.y", "tool.z"}) position = std::max(position, std::abs(a[c][i] - b[c][i]));
    for (const char* c : {"tool.cardan_1", "tool.cardan_2", "tool.cardan_3"})
      turn = std::max(turn, std::abs(a[c][i] - b[c][i]));
  }
  write_csv(samples::output("robot_arm.csv"), a);
  Panel angles{.y_label = "angle [rad]", .series = {}};
  for (int k = 1; k <= 6; ++k)
    angles.series.push_back(table_series(a, "t", fmt::format("J{}.rz", k), fmt::format("J{}", k)));
  write_chart(
      samples::output("robot_arm"),
      {.title = "Joint angles of an arm whose tool follows a trajectory", .x_label = "t [s]", .panels = {angles}});
  fmt::print("tool led and tool driven through the joints differ by {:.1e} m and {:.1e} rad over {:.1f} s\n", position,
             turn, kEnd);
  fmt::print("{}, robot_arm.svg, robot_arm.png\n", samples::output("robot_arm.csv"));
  return position < 1e-10 && turn < 1e-10 ? 0 : 1;
}
