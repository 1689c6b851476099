// All equilibria that many random starts lead to.
#include <lockstep/equilibrium.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/analysis/wild_starts.h"

namespace lockstep {
namespace {

/// Whether two equilibria are one: the same poses, or, where a motion is held by nothing, the same family of them.
bool same_equilibrium(const System& system, const Equilibrium& a, const Equilibrium& b, double same) {
  std::string body;
  if (apart(system, a.state, b.state, body) <= same * system.length()) return true;
  constexpr double kAlike = 1e-6;
  const Stability &s = a.report.stability, &o = b.report.stability;
  const auto alike = [](double x, double y) { return std::abs(x - y) <= kAlike * std::max(std::abs(x), std::abs(y)); };
  return !s.neutral.empty() && s.neutral.size() == o.neutral.size() && s.unstable.size() == o.unstable.size() &&
         alike(s.softest, o.softest) && alike(a.report.largest_force, b.report.largest_force);
}

}  // namespace

EquilibriaReport find_equilibria(Dynamics& dynamics, const State& start, const EquilibriaOptions& options) {
  const System& system = dynamics.system();
  EquilibriaReport report;
  State first = start;
  dynamics.to_slots(first);
  const auto take = [&](Equilibrium found) {
    const auto known = std::ranges::find_if(
        report.all, [&](const Equilibrium& e) { return same_equilibrium(system, e, found, options.same); });
    if (known != report.all.end())
      ++known->found;
    else
      report.all.push_back(std::move(found));
  };
  Equilibrium own{first, {}, 1};
  own.report = find_equilibrium(dynamics, own.state);
  take(std::move(own));
  report.starts = 1;
  Scatter random(options.seed);
  for (int k = 0; k < options.starts; ++k, ++report.starts) {
    Equilibrium next{first, {}, 1};
    next.state.v.setZero();
    scatter(system, 2 * system.length(), random, next.state);
    try {
      if (!fit(dynamics, next.state)) throw SolveError("off its rows");
      // Newton's method alone goes to unstable ones too; every other start goes downhill.
      next.report = find_equilibrium(dynamics, next.state, {.relaxation_steps = 0, .nearest = k % 2 == 0});
      take(std::move(next));
    } catch (const SolveError&) {
      ++report.failed;
    } catch (const NonFiniteError&) {
      ++report.failed;
    }
  }
  std::ranges::stable_sort(report.all, {}, [](const Equilibrium& e) { return e.report.stability.unstable.size(); });
  return report;
}

}  // namespace lockstep
