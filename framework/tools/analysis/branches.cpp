// SPDX-License-Identifier: BSD-3-Clause
// The assemblies of a mechanism, from many random starts.
#include <lockstep/branches.h>

#include <algorithm>

#include <lockstep/analysis.h>
#include <lockstep/assembly.h>
#include <lockstep/error.h>
#include <lockstep/kinematics.h>
#include "framework/tools/analysis/wild_starts.h"

namespace lockstep {

BranchReport find_branches(Dynamics& dynamics, const State& start, const BranchOptions& options) {
  const System& system = dynamics.system();
  State first = dynamics.in_slots(start);
  first.v.setZero();
  assemble(dynamics, first);
  if (const DriveReport driven = driven_by(dynamics, first); driven.freedoms > 0)
    throw ModelError("branches need a fully driven mechanism: " + driven.text());
  const double same = options.same * system.length();
  BranchReport report;
  report.branches.push_back({first, 1, 0, 0, ""});
  report.starts = 1;
  Draw random(options.seed);
  for (; report.starts <= options.starts; ++report.starts) {
    State state = first;
    scatter(system, 2 * system.length(), random, state);
    if (!fit(dynamics, state)) {
      ++report.failed;
      continue;
    }
    const int freedoms = mobility(dynamics, state).freedoms;
    const auto known = std::ranges::find_if(report.branches, [&](const AssemblyBranch& b) {
      return b.freedoms == freedoms && (freedoms > 0 || apart(system, b.state, state) <= same);
    });
    if (known != report.branches.end()) {
      ++known->found;
      continue;
    }
    std::string body;
    const double distance = apart(system, first, state, &body);
    report.branches.push_back({std::move(state), 1, freedoms, distance, body});
  }
  std::ranges::stable_sort(report.branches, {}, &AssemblyBranch::distance);
  return report;
}

}  // namespace lockstep
