// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/analysis.h>

#include <vector>

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {

MobilityReport mobility(Dynamics& dynamics, const State& state) {
  const Evaluation& evaluation = dynamics.gather_rows(state);
  const System& system = dynamics.system();
  const RowTable& table = evaluation.rows();
  MobilityReport report;
  report.bodies = system.n_slots();
  report.unknowns = system.n_velocities();
  report.rows = table.n_rows;
  std::vector<bool> takes_part(system.links().size(), false);
  for (const std::vector<int>& entries : loops_of(system, table)) {
    const LoopRows rows(system, table, entries);
    const Dependencies dependencies(rows.Jt);
    report.rank += dependencies.rank;
    for (const DependentRows& set : dependencies.sets) {
      Dependency& found = report.dependencies.emplace_back();
      found.too_many = set.too_many, found.nearly = set.nearly, found.pivot = set.pivot;
      for (const int row : set.rows) {
        const NamedRow named(system, table, rows.numbers[row]);
        found.rows.push_back(named.name());
        if (set.too_many > 0) takes_part[named.link->number()] = true;
      }
    }
  }
  for (const auto& link : system.links())
    if (takes_part[link->number()]) report.redundant_links.push_back(link->name());
  report.freedoms = report.unknowns - report.rank;
  report.redundant = report.rows - report.rank;
  return report;
}

}  // namespace lockstep
