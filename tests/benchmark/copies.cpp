// SPDX-License-Identifier: BSD-3-Clause
// What eight copies in lanes cost, against the same evaluations one by one: chains of hinged rods and rows of four-bars,
// in one run. With arguments, files of scenes: what each costs in both formulations, and the operations by which one of them is
// chosen.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <lockstep/author/registry.h>
#include <lockstep/error.h>
#include <lockstep/scene.h>
#include <lockstep/solvers.h>
#include "framework/description/scene/system_of.h"
#include "framework/dynamics/tree/joint_cost.h"
#include "framework/dynamics/tree/tree_layout.h"
#include "framework/tools/batch/batch.h"
#include "framework/tools/precision/work_precision.h"
#include "tests/support/copies_of.h"

using namespace lockstep;

namespace {

constexpr double kRound = 0.03;  // s of CPU time
constexpr int kRounds = 15;

/// Nanoseconds of one call of `act`, the least of some rounds.
template <class F>
double nanoseconds(F&& act) {
  double best = HUGE_VAL;
  act();
  for (int round = 0; round < kRounds; ++round) {
    long n = 0;
    const double begin = thread_seconds();
    double spent = 0;
    for (; spent < kRound; spent = thread_seconds() - begin)
      for (int i = 0; i < 20; ++i, ++n) act();
    best = std::min(best, 1e9 * spent / static_cast<double>(n));
  }
  return best;
}

/// Per body, copy and evaluation; NaN where the machine has not got the instructions or the mechanism no such lanes.
double in_lanes(test::Family& family, const std::vector<State>& states, Instructions set) try {
  CopiesOptions options;
  options.instructions = set, options.formulation = Formulation::joint;
  const std::vector<System*> systems = family.pointers();
  if (!Copies::unsuited(*systems[0], Formulation::joint).empty()) return NAN;
  const auto batch = std::make_unique<lanes::Batch>(systems, 0, options);
  Aligned<double> y(batch->n_numbers()), rate(batch->n_numbers());
  for (int l = 0; l < lanes::kLanes; ++l) {
    State state = states[l];
    batch->to_batch(l, state);
    batch->put(l, state, y.data());
  }
  return nanoseconds([&] { batch->evaluate(y.data(), {}, rate.data()); }) / (lanes::kLanes * systems[0]->n_slots());
} catch (const ModelError&) {
  return NAN;
}

double one_by_one(test::Family& family, const std::vector<State>& states, Formulation formulation) {
  DynamicsOptions options;
  options.formulation = formulation;
  Dynamics dynamics(*family.systems[0], std::make_unique<SchurSolver>(), options);
  State state = states[0];
  dynamics.to_formulation(state);
  if ((formulation == Formulation::joint) != (state.coordinates != nullptr)) return NAN;
  StateRate rate;
  return nanoseconds([&] { dynamics.rates(state, rate); }) / family.systems[0]->n_slots();
}

template <class Make>
void table(const char* what, std::initializer_list<int> sizes, Make&& make) {
  fmt::print("{}\n{:>7} | {:>10} | {:>10} {:>8} {:>8} {:>8}\n", what, "size", "omega", "joint", "plain", "FMA",
             "AVX-512");
  for (const int n : sizes) {
    test::Family family(lanes::kLanes, [&](int k) { return make(n, k); });
    const std::vector<State> states = family.assembled();
    const auto lanes = [&](Instructions set) { return in_lanes(family, states, set); };
    fmt::print("{:7} | {:10.1f} | {:10.1f} {:8.1f} {:8.1f} {:8.1f}\n", n,
               one_by_one(family, states, Formulation::omega), one_by_one(family, states, Formulation::joint),
               lanes(Instructions::plain), lanes(Instructions::fma), lanes(Instructions::avx512));
  }
}

/// The operations that are predicted for one mechanism, joint against omega.
void print_operations(const System& system) {
  const std::vector<bool>& modes = system.start().modes;
  const TreeLayout layout = lay_out_tree(system, modes, Taken::all);
  if (!layout.tree || !layout.tree->has_rows()) return fmt::print("{:>9}\n", "-");
  fmt::print("{:9.2f}\n", count_operations(*layout.tree, layout.fronts, layout.closures).total() /
                              count_in_omega(system, modes, layout.closures).total());
}

void scene_row(const std::string& file) try {
  const Registry registry = builtin_registry();
  const Scene scene = in_space(read_scene(file));
  test::Family family(lanes::kLanes, [&](int) {
    Mechanism m = build_mechanism(scene, registry);
    return std::make_unique<System>(std::move(system_of(m)));
  });
  const std::vector<State> states = family.assembled();
  fmt::print("{:32.32} | {:7.1f} | {:7.1f} {:8.1f} | ", file.substr(file.rfind('/') + 1),
             one_by_one(family, states, Formulation::omega), one_by_one(family, states, Formulation::joint),
             in_lanes(family, states, Instructions::best));
  print_operations(*family.systems[0]);
} catch (const Error& error) {
  fmt::print("{}: {}\n", file, error.what());
}

}  // namespace

int main(int n_arguments, char** arguments) {
  fmt::print("CPU ns a body, copy and evaluation: one mechanism, and eight in lanes\n");
  if (n_arguments > 1) {
    fmt::print("{:32} | {:>7} | {:>7} {:>8} | {:>9}\n", "scene", "omega", "joint", "in lanes", "predicted");
    for (int i = 1; i < n_arguments; ++i) scene_row(arguments[i]);
    return 0;
  }
  table("chain of hinges whose axes differ", {1, 4, 10, 100}, [](int n, int k) { return test::chain(n, k, 0.7); });
  table("chain in a plane", {1, 4, 10, 100}, [](int n, int k) { return test::chain(n, k); });
  table("row of four-bars", {1, 2, 10}, [](int n, int k) { return test::ladder(n, k); });
  table("row of four-bars askew, with redundant rows", {1, 2, 10},
        [](int n, int k) { return test::ladder(n, k, axis_angle(Vec3(1, 2, 3).normalized(), 0.7)); });
}
