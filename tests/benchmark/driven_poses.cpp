// SPDX-License-Identifier: BSD-3-Clause
// Poses of driven mechanisms per second, with all reactions: DrivenMotion on scenes, at three distances of poses.
//   driven_poses [SCENE.json ...]
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/kinematics.h>
#include <lockstep/lockstep.h>
#include "framework/description/scene/system_of.h"
#include "tests/support/paths.h"

namespace {

using namespace lockstep;

constexpr int kPoses = 50'000;

void measure(const std::string& file, double interval) {
  Mechanism m = build_mechanism(read_scene(file), builtin_registry());
  Dynamics dynamics(system_of(m), make_solver(m.run, builtin_registry()), {m.run.formulation, m.run.stabilization});
  State start = m.system.start();
  assemble(dynamics, start);
  DrivenMotion motion(dynamics, std::move(start));
  motion.to(0);
  double t = 0, way = interval, sum = 0;
  const auto begun = std::chrono::steady_clock::now();
  for (int k = 0; k < kPoses; ++k) {  // to and fro
    if (t + way > m.run.until || t + way < 0) way = -way;
    t += way;
    sum += motion.to(t).lambda[0];
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  std::printf("%-60s every %g s: %9.0f poses a second (%g)\n", file.c_str(), interval, kPoses / seconds, sum);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + 1, argv + argc);
  if (files.empty())
    for (const char* name : {"four_bar", "slider_crank", "peaucellier", "robot_arm"})
      files.push_back(std::string(paths::kScenes) + "/" + name + ".json");
  for (const std::string& file : files)
    for (const double interval : {1e-2, 1e-3, 1e-4}) measure(file, interval);
  return 0;
}
