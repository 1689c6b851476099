// SPDX-License-Identifier: BSD-3-Clause
// How often a scene is assembled from starts that have nothing to do with it: wild_starts SCENE.json [N], 1000 of them unless N
// is given. tests/verification/data/wild_starts.csv holds what it found.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "framework/tools/analysis/wild_starts.h"

using namespace lockstep;

namespace {

struct WildStarts {
  int starts = 0, assembled = 0;
  long iterations = 0;                  // of those that were assembled
  double violation = 0;                 // the largest that one of them leaves, m
  std::vector<double> moved;            // how far each of them is from where it began, m, turns times System::length()
  std::map<std::string, int> failures;  // by the kind of the error
};

// Bodies anywhere within twice the length of the mechanism of where the scene puts them, turned any way, at rest.
WildStarts try_starts(Mechanism& m, Dynamics& dynamics, int starts) {
  WildStarts out;
  State first = m.system.start();
  dynamics.to_slots(first);
  first.v.setZero();
  Draw random(1);
  for (; out.starts < starts; ++out.starts) {
    State state = first;
    scatter(m.system, 2 * m.system.length(), random, state);
    const State wild = state;
    try {
      const AssemblyReport report = assemble(dynamics, state);
      ++out.assembled;
      out.iterations += report.iterations;
      out.violation = std::max(out.violation, report.after);
      out.moved.push_back(apart(m.system, wild, state));
    } catch (const AssemblyError&) {
      ++out.failures["ended off the constraints"];
    } catch (const SolveError&) {
      ++out.failures["rows contradict one another on the way"];
    } catch (const NonFiniteError&) {
      ++out.failures["a law or function of a joint has no value there"];
    }
  }
  std::ranges::sort(out.moved);
  return out;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string file = argc > 1 ? argv[1] : "samples/scenes/four_bar.json";
  const int starts = argc > 2 ? std::atoi(argv[2]) : 1000;
  const Registry registry = builtin_registry();
  Mechanism m = build_mechanism(read_scene(file), registry);
  Dynamics dynamics(system_of(m), std::make_unique<SchurSolver>());
  set_logger(nullptr);  // every start is far off
  const WildStarts w = try_starts(m, dynamics, starts);
  fmt::print("assembled  {} of {} wild starts ({:.1f} %), in {:.3g} iterations on average, to {:.2g} m\n", w.assembled,
             w.starts, 100.0 * w.assembled / std::max(w.starts, 1),
             static_cast<double>(w.iterations) / std::max(w.assembled, 1), w.violation);
  if (!w.moved.empty())
    fmt::print("moved      half of them by more than {:.3g} m (turns by the length of the mechanism, {:.3g} m)\n",
               w.moved[w.moved.size() / 2], m.system.length());
  for (const auto& [why, n] : w.failures) fmt::print("failed     {}: {}\n", n, why);
} catch (const Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
