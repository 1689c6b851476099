// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/pareto.h"

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

constexpr double kLuck = 2;  // factor by which the error of a finer run may be larger

}  // namespace

double cost(const WorkPrecisionRun& run, CostKind kind) {
  return kind == CostKind::cpu ? run.cpu : static_cast<double>(run.evaluations);
}

bool counts(const WorkPrecision& result, const WorkPrecisionRun& run, ErrorKind kind) {
  if (!run.done() || run.wrong || !std::isfinite(run.error.of(kind))) return false;
  const double limit = kLuck * std::max(run.error.of(kind), result.agreement.of(kind));
  return std::none_of(result.runs.begin(), result.runs.end(), [&](const WorkPrecisionRun& other) {
    const bool finer = same_way(other, run) && other.setting < run.setting;
    return finer && (other.done() ? !(other.error.of(kind) <= limit) : !other.given_up);
  });
}

std::vector<const WorkPrecisionRun*> pareto_front(const WorkPrecision& result, ErrorKind kind, CostKind by) {
  std::vector<const WorkPrecisionRun*> all, front;
  for (const WorkPrecisionRun& run : result.runs)
    if (counts(result, run, kind)) all.push_back(&run);
  std::stable_sort(all.begin(), all.end(), [&](const WorkPrecisionRun* a, const WorkPrecisionRun* b) {
    return cost(*a, by) != cost(*b, by) ? cost(*a, by) < cost(*b, by) : a->error.of(kind) < b->error.of(kind);
  });
  double best = HUGE_VAL;
  for (const WorkPrecisionRun* run : all) {
    if (!(run->error.of(kind) < best)) continue;
    front.push_back(run);
    best = run->error.of(kind);
    if (best <= result.agreement.of(kind)) break;  // the reference itself is not known better
  }
  return front;
}

std::vector<CostAtError> costs_at_error(const WorkPrecision& result, double error, ErrorKind kind) {
  std::vector<CostAtError> costs;
  for (const WorkPrecisionRun& run : result.runs) {
    if (!counts(result, run, kind) || run.error.of(kind) > error) continue;
    const auto of_same = [&](const CostAtError& c) { return same_way(*c.run, run); };
    const auto known = std::find_if(costs.begin(), costs.end(), of_same);
    CostAtError now{&run, true, false};
    for (const WorkPrecisionRun& other : result.runs) {
      if (!same_way(other, run)) continue;
      if (other.setting > run.setting) now.upper_bound = false;
      if (other.done() && other.setting < run.setting) now.confirmed = true;
    }
    if (known == costs.end())
      costs.push_back(now);
    else if (now.confirmed != known->confirmed ? now.confirmed : run.cpu < known->run->cpu)
      *known = now;
  }
  std::stable_sort(costs.begin(), costs.end(),
                   [](const CostAtError& a, const CostAtError& b) { return a.run->cpu < b.run->cpu; });
  return costs;
}

const CostAtError* recommended(const std::vector<CostAtError>& costs) {
  const bool any_confirmed = std::ranges::any_of(costs, &CostAtError::confirmed);
  const CostAtError *cheapest = nullptr, *best = nullptr;
  for (const CostAtError& c : costs) {
    if (c.confirmed != any_confirmed) continue;
    if (cheapest == nullptr) cheapest = best = &c;
    if (c.run->cpu <= kTie * cheapest->run->cpu && c.run < best->run) best = &c;  // runs are in the order of the plan
  }
  return best;
}

}  // namespace lockstep
