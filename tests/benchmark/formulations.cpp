// SPDX-License-Identifier: BSD-3-Clause
// What an evaluation costs along joints and in omega, against the operations that both plans predict: by these `auto` chooses.
// Arguments: files of scenes, with loops. At the end Operations::kVisit, by which measured and predicted ratios differ least.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/author/registry.h>
#include <lockstep/dynamics.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/tree/joint_cost.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/tools/precision/work_precision.h"

using namespace lockstep;

namespace {

constexpr double kRound = 0.004;  // s of CPU time
constexpr int kRounds = 25;

/// A mechanism after some hundredths of a second of motion, on the constraints.
struct Moved {
  Mechanism mechanism;
  std::unique_ptr<Dynamics> dynamics;
  State state;
  StateRate rate;
  double best = HUGE_VAL;  ///< ns of an evaluation

  Moved(Scene scene, Formulation formulation) {
    scene.run.formulation = formulation;
    mechanism = build_mechanism(scene, builtin_registry());
    dynamics = std::make_unique<Dynamics>(system(), std::make_unique<SchurSolver>(), DynamicsOptions{formulation, {}});
    state = system().start();
    if (mechanism.run.assemble) assemble(*dynamics, state, mechanism.start_speeds, mechanism.assembly);
    dynamics->to_slots(state);
    State last = state;
    try {
      for (int i = 0; i < 200; ++i, last = state) step(5e-4);
    } catch (const Error&) {
      state = last;
    }
    dynamics->to_formulation(state);
    dynamics->rates(state, rate);
  }
  System& system() { return system_of(mechanism); }
  void step(double h) {
    dynamics->rates(state, rate), state.v += h * rate.v;
    dynamics->rates(state, rate), state.q += h * rate.q;
    state.t += h;
    dynamics->project(state), dynamics->project_velocity(state);
  }
  void time() {
    long n = 0;
    const double begin = thread_seconds();
    double spent = 0;
    for (; spent < kRound; spent = thread_seconds() - begin)
      for (int i = 0; i < 20; ++i, ++n) dynamics->rates(state, rate);
    best = std::min(best, 1e9 * spent / static_cast<double>(n));
  }
};

struct Line {
  double measured = 0;  ///< joint against omega
  Operations joint, omega;
  /// The logarithm of the measured over the predicted ratio.
  double miss(double visit) const {
    const auto total = [&](const Operations& o) { return o.multiply_adds + visit * o.visits; };
    return std::log(measured * total(omega) / total(joint));
  }
};

/// Root mean square.
double spread(const std::vector<Line>& lines, double visit) {
  double sum = 0;
  for (const Line& l : lines) sum += l.miss(visit) * l.miss(visit);
  return std::sqrt(sum / static_cast<double>(lines.size()));
}

void measure(const std::string& file, std::vector<Line>& lines) try {
  const Scene scene = read_scene(file);
  Moved omega(scene, Formulation::omega), joint(scene, Formulation::joint), automatic(scene, Formulation::automatic);
  System& system = joint.system();
  if (!joint.state.coordinates || !joint.state.coordinates->has_rows()) return;
  if (bool(system.plane()) != bool(omega.system().plane())) return;  // `auto` would not compare these
  for (int round = 0; round < kRounds; ++round) omega.time(), joint.time();
  const TreeLayout layout = lay_out_tree(system, joint.state.modes, Taken::all);
  const Line line{joint.best / omega.best, count_operations(*layout.tree, layout.fronts, layout.closures),
                  count_in_omega(system, joint.state.modes, layout.closures)};
  lines.push_back(line);
  fmt::print("{:32.32} {:6} | {:8.0f} {:8.0f} {:6.2f} | {:8.0f} {:8.0f} {:6.2f} | {}\n",
             file.substr(file.rfind('/') + 1), system.n_slots(), omega.best, joint.best, line.measured,
             line.omega.total(), line.joint.total(), line.joint.total() / line.omega.total(),
             automatic.state.coordinates ? "joint" : "omega");
} catch (const Error& error) {
  fmt::print(stderr, "{}: {}\n", file, error.what());
}

}  // namespace

int main(int n_arguments, char** arguments) {
  fmt::print("{:32} {:>6} | {:>8} {:>8} {:>6} | {:>8} {:>8} {:>6} |\n", "", "bodies", "omega ns", "joint", "ratio",
             "op. om.", "joint", "ratio");
  std::vector<Line> lines;
  for (int i = 1; i < n_arguments; ++i) measure(arguments[i], lines);
  if (lines.empty()) return 0;
  fmt::print("a visit, and the spread of ln(measured / predicted):");
  for (int visit = 0; visit <= 60; visit += 5) fmt::print("  {} {:.3f}", visit, spread(lines, visit));
  double sum = 0;
  for (const Line& l : lines) sum += l.miss(Operations::kVisit);
  fmt::print("\ntime of an operation along joints, that in omega being 1: {:.2f}\n",
             std::exp(sum / static_cast<double>(lines.size())));
}
