// What eight copies in lanes cost, against the same evaluations one by one: chains of hinged rods, in one run.
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

/// Per body, copy and evaluation; NaN where the machine has not got the instructions.
double in_lanes(test::Family& family, const std::vector<State>& states, int n, Instructions set) try {
  CopiesOptions options;
  options.instructions = set;
  const std::vector<System*> systems = family.pointers();
  lanes::Batch batch(systems, 0, options);
  Aligned<double> y(batch.n_numbers()), rate(batch.n_numbers());
  for (int l = 0; l < lanes::kLanes; ++l) batch.put(l, states[static_cast<std::size_t>(l)], y.data());
  return nanoseconds([&] { batch.evaluate(y.data(), {}, rate.data()); }) / (lanes::kLanes * n);
} catch (const ModelError&) {
  return NAN;
}

double one_by_one(test::Family& family, const std::vector<State>& states, int n) {
  Dynamics dynamics(*family.systems[0], std::make_unique<SchurSolver>());
  StateRate rate;
  return nanoseconds([&] { dynamics.rate(states[0], rate); }) / n;
}

}  // namespace

int main() {
  fmt::print("CPU ns a body and evaluation, chain of hinged rods, eight copies\n{:>7} {:>10} {:>8} {:>8} {:>8} {:>8}\n",
             "bodies", "one by one", "plain", "FMA", "AVX-512", "ratio");
  for (const int n : {1, 4, 10, 100}) {
    test::Family family(lanes::kLanes, [&](int k) { return test::chain(n, k); });
    const std::vector<State> states = family.starts();
    const double alone = one_by_one(family, states, n), plain = in_lanes(family, states, n, Instructions::plain),
                 fma = in_lanes(family, states, n, Instructions::fma),
                 avx512 = in_lanes(family, states, n, Instructions::avx512);
    double best = plain;
    for (const double t : {fma, avx512})
      if (t < best) best = t;
    fmt::print("{:7} {:10.1f} {:8.1f} {:8.1f} {:8.1f} {:8.1f}\n", n, alone, plain, fma, avx512, alone / best);
  }
}
