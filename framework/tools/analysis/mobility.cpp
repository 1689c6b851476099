#include <lockstep/analysis.h>

#include <algorithm>
#include <vector>

#include "framework/tools/analysis/dependency.h"
#include "framework/tools/analysis/loop_rows.h"

namespace lockstep {
namespace {

std::vector<std::string> row_names(const System& system, const RowTable& table, const LoopRows& rows,
                                   const std::vector<int>& which) {
  std::vector<std::string> names;
  for (const int row : which) names.push_back(name_of_row(system, table, rows.number(row)));
  return names;
}

void mark_links(const RowTable& table, const LoopRows& rows, const DependentRows& set, std::vector<bool>& takes_part) {
  for (const int row : set.rows)
    takes_part[static_cast<std::size_t>(entry_of_row(table, rows.number(row)).link)] = true;
}

}  // namespace

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
    const Dependencies found = find_dependencies(rows);
    report.rank += found.rank;
    for (const DependentRows& set : found.sets) {
      report.dependencies.push_back({row_names(system, table, rows, set.rows), set.too_many, set.nearly, set.pivot});
      if (set.too_many > 0) mark_links(table, rows, set, takes_part);
    }
  }
  for (const auto& link : system.links())
    if (takes_part[static_cast<std::size_t>(link->number())]) report.redundant_links.push_back(link->name());
  report.freedoms = report.unknowns - report.rank;
  report.redundant = report.rows - report.rank;
  return report;
}

}  // namespace lockstep
