// SPDX-License-Identifier: BSD-3-Clause
// Time of an evaluation of the equations of motion with each feature absent and present; CSV and bars.
#include <fstream>

#include <spdlog/fmt/fmt.h>

#include <lockstep/assembly.h>
#include <lockstep/charts.h>
#include <lockstep/detail/newton.h>
#include <lockstep/integrators.h>
#include <lockstep/recorder.h>
#include "framework/tools/precision/work_precision.h"
#include "samples/shared/output.h"
#include "tests/support/economies.h"

using namespace lockstep;
using namespace lockstep::economies;

namespace {

/// Microseconds of an evaluation, the least of nine rounds; with the tangents and the matrix of an implicit method, if
/// they are wanted.
double microseconds(Chain chain, bool tangents = false) {
  Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
  State state = chain.sys->start();
  assemble(dynamics, state);
  StateRate rate;
  const Solution& solution = dynamics.rate(state, rate);
  NewtonMatrix matrix;
  const auto implicit = [&] {
    matrix.gather(solution.evaluation, solution.lambda);
    matrix.factor(1.0, 1e-3, 1e-6);
  };
  double best = HUGE_VAL;
  for (int round = 0; round < 9; ++round) {
    long n = 0;
    const double begin = thread_seconds();
    double spent = 0;
    for (; spent < 0.03; spent = thread_seconds() - begin)
      for (int i = 0; i < 10; ++i, ++n) {
        state.v[0] += 1e-12;
        dynamics.rate(state, rate);
        if (tangents) implicit();
      }
    best = std::min(best, 1e6 * spent / static_cast<double>(n));
  }
  return best;
}

/// Microseconds of a run by rk4 for each of its evaluations, every step recorded; the least of nine runs.
double microseconds_recorded(const std::vector<Request>& columns) {
  constexpr int kSteps = 200;
  double best = HUGE_VAL;
  for (int round = 0; round < 9; ++round) {
    Chain chain = plain();
    Recorder recorder(*chain.sys, columns);
    Dynamics dynamics(*chain.sys, std::make_unique<SchurSolver>());
    StepLoop run(dynamics, std::make_unique<Rk4>(), {.step = 1e-3, .tolerance = {}});
    run.add_observer(recorder);
    run.step();
    const double begin = thread_seconds();
    for (int i = 0; i < kSteps; ++i) run.step();
    best = std::min(best, 1e6 * (thread_seconds() - begin) / (4 * kSteps));
  }
  return best;
}

}  // namespace

int main() {
  BarSpec bars{"A chain of six bodies: what each feature adds to an evaluation",
               "CPU time of an evaluation [us]",
               {},
               {{"without the feature", {}, "#9fd3c7"}, {"with the feature", {}, "#385170"}}};
  const std::string file = samples::output("economies.csv");
  std::ofstream csv(file);
  csv << "feature,absent,present,unknowns absent,unknowns present,rows absent,rows present,cpu absent [us],cpu present "
         "[us]\n";
  fmt::print("{:20} {:>9} {:>9}   unknowns, rows\n", "", "absent us", "present");
  const auto add = [&](const std::string& name, const std::string& absent_is, const std::string& present_is,
                       double absent, double present, Size a, Size p) {
    bars.categories.push_back(name);
    bars.groups[0].values.push_back(absent), bars.groups[1].values.push_back(present);
    csv << fmt::format("{},{},{},{},{},{},{},{:.4g},{:.4g}\n", name, absent_is, present_is, a.unknowns, p.unknowns,
                       a.rows, p.rows, absent, present);
    fmt::print("{:20} {:9.2f} {:9.2f}   {}, {} -> {}, {}: {} -> {}\n", name, absent, present, a.unknowns, a.rows,
               p.unknowns, p.rows, absent_is, present_is);
  };
  for (const Economy& e : all())
    add(e.name, e.absent_is, e.present_is, microseconds(e.absent()), microseconds(e.present()), size(e.absent()),
        size(e.present()));
  const Size s = size(plain());
  add("implicit method", "an explicit method's evaluation", "the same with the matrix of an implicit one",
      microseconds(plain()), microseconds(plain(), true), s, s);
  const double bare = microseconds_recorded({});
  add("recorded energy", "rk4: nothing recorded", "energy recorded at every step", bare,
      microseconds_recorded({"energy.total"}), s, s);
  add("recorded reactions", "rk4: nothing recorded", "all reactions recorded at every step", bare,
      microseconds_recorded([] {
        std::vector<Request> all_forces;
        for (int i = 0; i < kRods; ++i)
          for (const char* axis : {"x", "y", "z"})
            all_forces.push_back("joint" + std::to_string(i) + ".force_on_p_world_" + axis);
        return all_forces;
      }()),
      s, s);
  bars.width = 1250, bars.height = 520;
  write_bars(samples::output("economies"), bars);
  fmt::print("{}, economies.svg, economies.png\n", file);
}
