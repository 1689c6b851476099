// What eight copies in lanes cost, against the same evaluations one by one: chains of hinged rods and rows of four-bars,
// in one run.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "framework/tools/precision/work_precision.h"
#include "framework/tools/batch/batch.h"
#include <lockstep/solvers.h>
#include <lockstep/error.h>
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
double in_lanes(test::Family& family, const std::vector<State>& states, Formulation formulation, Instructions set) try {
  CopiesOptions options;
  options.instructions = set, options.formulation = formulation;
  const std::vector<System*> systems = family.pointers();
  if (!Copies::unsuited(*systems[0], formulation).empty()) return NAN;
  const std::unique_ptr<lanes::Batch> batch = lanes::Batch::of(systems, 0, options);
  Aligned<double> y(batch->n_numbers()), rate(batch->n_numbers());
  for (int l = 0; l < lanes::kLanes; ++l) {
    State state = states[static_cast<std::size_t>(l)];
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
  fmt::print("{}\n{:>7} | {:>10} {:>8} | {:>10} {:>8} {:>8} {:>8}\n", what, "size", "omega", "in lanes", "joint",
             "plain", "FMA", "AVX-512");
  for (const int n : sizes) {
    test::Family family(lanes::kLanes, [&](int k) { return make(n, k); });
    const std::vector<State> states = family.assembled();
    const auto joint = [&](Instructions set) { return in_lanes(family, states, Formulation::joint, set); };
    fmt::print("{:7} | {:10.1f} {:8.1f} | {:10.1f} {:8.1f} {:8.1f} {:8.1f}\n", n,
               one_by_one(family, states, Formulation::omega),
               in_lanes(family, states, Formulation::omega, Instructions::best),
               one_by_one(family, states, Formulation::joint), joint(Instructions::plain), joint(Instructions::fma),
               joint(Instructions::avx512));
  }
}

}  // namespace

int main() {
  fmt::print("CPU ns a body, copy and evaluation: one mechanism, and eight in lanes\n");
  table("chain of hinges whose axes differ", {1, 4, 10, 100}, [](int n, int k) { return test::chain(n, k, 0.7); });
  table("chain in a plane", {1, 4, 10, 100}, [](int n, int k) { return test::chain(n, k); });
  table("row of four-bars", {1, 10}, [](int n, int k) { return test::ladder(n, k); });
}
