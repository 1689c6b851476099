// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/analysis.h>

#include <vector>

#include "framework/dynamics/evaluate/row_space.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {
namespace {

// Adds the part of the rank that is due to drives, and the names of these drives, "A.rz".
void add_drives(const System& system, const RowTable& table, const LoopRows& rows, int rank, MobilityReport& report) {
  std::vector<int> others;
  std::vector<std::string> names;
  for (int k = 0; k < rows.n(); ++k) {
    if (const std::string drive = NamedRow(system, table, rows.numbers[k]).drive(); !drive.empty())
      add_name(drive, names);
    else
      others.push_back(k);
  }
  if (names.empty()) return;
  SparseMat Jt(rows.Jt.rows(), static_cast<Eigen::Index>(others.size()));
  for (std::size_t k = 0; k < others.size(); ++k) Jt.col(static_cast<Eigen::Index>(k)) = rows.Jt.col(others[k]);
  const int driven = rank - Dependencies(Jt).rank;
  report.driven += driven;
  for (const std::string& name : names) {
    add_name(name, report.drives);
    if (driven == 0 && rank == rows.at.n()) add_name(name, report.locked);
  }
}

}  // namespace

MobilityReport mobility(Dynamics& dynamics, const State& state) {
  const Evaluation& evaluation = dynamics.gather_rows(state);
  const System& system = dynamics.system();
  RowTable room;
  std::vector<const RowTable*> tables{&evaluation.rows(), &all_rows(evaluation, state, room)};
  MobilityReport report;
  report.bodies = system.n_slots();
  report.unknowns = system.n_velocities();
  report.rows = tables.back()->n_rows;
  if (tables.front() == tables.back()) tables.pop_back();
  std::vector<bool> takes_part(system.links().size(), false);
  for (const RowTable* table : tables)
    for (const std::vector<int>& entries : loops_of(system, *table)) {
      const LoopRows rows(system, *table, entries);
      const Dependencies dependencies(rows.Jt);
      if (table == tables.front()) {
        report.rank += dependencies.rank;
        add_drives(system, *table, rows, dependencies.rank, report);
      }
      if (table != tables.back()) continue;
      for (const DependentRows& set : dependencies.sets) {
        Dependency& found = report.dependencies.emplace_back();
        found.too_many = set.too_many, found.nearly = set.nearly, found.pivot = set.pivot;
        for (const int row : set.rows) {
          const NamedRow named(system, *table, rows.numbers[row]);
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
