// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/commands/sweep_results.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace lockstep {
namespace {

constexpr long kMostListed = 20;  // runs

}  // namespace

SweepResults::SweepResults(const SweepPlan& plan)
    : plan_(plan), is_table_(plan.variables.size() == 1 && plan.grid.n_runs(plan.shard) <= kMostListed) {}

void SweepResults::add(long run, const SweepRun& done) {
  const std::vector<ColumnRange> columns = done.failed ? std::vector<ColumnRange>() : done.columns;
  if (is_table_) runs_.emplace_back(run, columns);
  const auto number = static_cast<double>(run);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const ColumnRange& range = columns[k];
    const Column& column = plan_.columns.columns()[k + 1];  // after t
    if (k == ends_.size()) ends_.push_back({{range, number, number}, column.name, column.unit});
    ColumnEnds& ends = ends_[k];
    if (range.least < ends.least) ends.least = range.least, ends.t_least = number;
    if (range.most > ends.most) ends.most = range.most, ends.t_most = number;
  }
}

std::string SweepResults::extremes() const {
  std::vector<ColumnEnds> all = ends_;
  for (ColumnEnds& c : all) {
    c.at_least = " (" + setting_text(plan_.shown, plan_.grid.at(static_cast<long>(c.t_least))) + ")";
    c.at_most = " (" + setting_text(plan_.shown, plan_.grid.at(static_cast<long>(c.t_most))) + ")";
  }
  drop_rounding(all, plan_.loaded.scene.run.tolerance.relative);
  return results_text(all, "in the table");
}

std::string SweepResults::table() const {
  std::vector<std::vector<std::string>> columns{{plan_.variables.front().path}};
  std::vector<ColumnEnds> cells;
  for (const auto& [run, ranges] : runs_) {
    const std::string value = setting_text(plan_.shown, plan_.grid.at(run));
    columns[0].push_back(value.substr(value.find('=') + 2));
    for (std::size_t k = 0; k < ends_.size(); ++k)
      cells.push_back({{ranges.empty() ? ColumnRange() : ranges[k]}, ends_[k].name, ends_[k].unit});
  }
  drop_rounding(cells, plan_.loaded.scene.run.tolerance.relative);
  for (std::size_t k = 0; k < ends_.size(); ++k) {
    columns.push_back({column_title({ends_[k].name, ends_[k].unit, {}})});
    for (std::size_t i = 0; i < runs_.size(); ++i)
      columns.back().push_back(runs_[i].second.empty() ? "no result" : range_text(cells[i * ends_.size() + k]));
  }
  std::vector<std::string> lines(runs_.size() + 1);
  std::size_t n = 0, width = 0;
  for (const std::vector<std::string>& column : columns) {
    const std::size_t more = std::ranges::max_element(column, {}, &std::string::size)->size() + 3;
    if (n > 1 && width + more > kResultsWidth) break;
    for (std::size_t i = 0; i < lines.size(); ++i) lines[i] += fmt::format("{:<{}}", column[i], more);
    width += more, ++n;
  }
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    lines[i].erase(lines[i].find_last_not_of(' ') + 1);
    if (i == 0 && n < columns.size()) lines[i] += fmt::format("   (all {}: in the table)", ends_.size());
    text += fmt::format("  {:<9}  {}\n", i == 0 ? "results" : "", lines[i]);
  }
  return text;
}

}  // namespace lockstep
