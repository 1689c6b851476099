// The option --wild of the verb assemble: how often a scene is assembled from starts that have nothing to do with it.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include "framework/tools/analysis/wild_starts.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/scene_run/scene_run.h"

namespace lockstep {
namespace {

constexpr int kMostWildStarts = 1'000'000;

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
  Scatter random(1);
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
      ++out.failures["a law or function of a link has no value there"];
    }
  }
  std::ranges::sort(out.moved);
  return out;
}

}  // namespace

int wild_command(const Arguments& args) {
  const int starts = whole_number("--wild", args.wild, kMostWildStarts);
  const Loaded loaded = load(args);
  Mechanism m = build_mechanism(loaded.scene, loaded.registry);
  Dynamics dynamics = make_dynamics(m, loaded.registry);
  set_logger(nullptr);  // every start is far off
  const WildStarts w = try_starts(m, dynamics, starts);
  const double mean = w.assembled > 0 ? static_cast<double>(w.iterations) / w.assembled : 0;
  const double middle = w.moved.empty() ? 0 : w.moved[w.moved.size() / 2];
  if (args.json) {
    nlohmann::ordered_json failures = nlohmann::ordered_json::object();
    for (const auto& [why, n] : w.failures) failures[why] = n;
    print_document(nlohmann::ordered_json({{"scene", loaded.scene.file},
                                           {"starts", w.starts},
                                           {"assembled", w.assembled},
                                           {"iterations", mean},
                                           {"violation", w.violation},
                                           {"moved", middle},
                                           {"length", m.system.length()},
                                           {"failures", failures}}));
    return kExitOk;
  }
  fmt::print("{}\n  assembled  {} of {} wild starts ({:.1f} %), in {:.3g} iterations on average, to {:.2g} m\n",
             loaded.title(), w.assembled, w.starts, 100.0 * w.assembled / std::max(w.starts, 1), mean, w.violation);
  fmt::print("  moved      half of them by more than {:.3g} m (turns by the length of the mechanism, {:.3g} m)\n",
             middle, m.system.length());
  for (const auto& [why, n] : w.failures) fmt::print("  failed     {}: {}\n", n, why);
  return kExitOk;
}

}  // namespace lockstep
