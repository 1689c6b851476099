// SPDX-License-Identifier: BSD-3-Clause
// Assembly from starts that have nothing to do with the mechanism: no fewer than the committed table says of each sample
// (data/wild_starts.csv: of 1000, by the benchmark wild_starts, and of the first 30 of them).
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/sweep.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/analysis/wild_starts.h"
#include "tests/support/catch.h"
#include "tests/support/paths.h"
#include "tests/support/run_scene.h"

namespace wild_starts_test {

using namespace lockstep;

TEST_CASE("samples are assembled from random starts as often as the table states", "[verification][assembly]") {
  std::ifstream table(std::string(paths::kSource) + "/tests/verification/data/wild_starts.csv");
  std::string line;
  std::getline(table, line);
  int scenes = 0;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string name, of_1000, of_30;
    std::getline(cells, name, ','), std::getline(cells, of_1000, ','), std::getline(cells, of_30, ',');
    CAPTURE(name);
    Mechanism m = build_mechanism(read_scene(scene_path(name)), builtin_registry());
    Dynamics dynamics(system_of(m), make_solver(m.run, builtin_registry()), {m.run.formulation, m.run.stabilization});
    State first = m.system.start();
    dynamics.to_slots(first);
    first.v.setZero();
    Draw random(1);
    int assembled = 0;
    for (int k = 0; k < 30; ++k) {
      State state = first;
      scatter(m.system, 2 * m.system.length(), random, state);
      try {
        assemble(dynamics, state);
      } catch (const Error&) {
        continue;
      }
      ++assembled;
      CHECK(dynamics.violation(state) < 1e-9 * std::max(1.0, m.system.length()));
    }
    CHECK(assembled >= std::stoi(of_30) - 2);  // rounding differs from machine to machine
    ++scenes;
  }
  CHECK(scenes >= 30);
}

}  // namespace wild_starts_test
