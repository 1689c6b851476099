// SPDX-License-Identifier: BSD-3-Clause
// What a sweep prints of its results.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/program/run_words.h"

namespace lockstep {

/// The extremes of the recorded columns over the runs of a sweep. The plan must outlive it.
class SweepResults {
 public:
  explicit SweepResults(const SweepPlan& plan)
      : plan_(plan), is_table_(plan.variables.size() == 1 && plan.grid.n_runs(plan.shard) <= kMostListed) {}
  void add(long run, const SweepRun& done) {
    const std::vector<ColumnRange> columns = done.failed ? std::vector<ColumnRange>() : done.columns;
    if (is_table_) runs_.emplace_back(run, columns);
    const auto number = static_cast<double>(run);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const ColumnRange& range = columns[k];
      const Column& column = plan_.columns.columns()[k + 1];  // after t
      if (k == ends_.size())
        ends_.push_back({{range.last, range.least, range.most, number, number}, column.name, column.unit});
      ColumnEnds& ends = ends_[k];
      if (range.least < ends.least) ends.least = range.least, ends.t_least = number;
      if (range.most > ends.most) ends.most = range.most, ends.t_most = number;
    }
  }
  /// Of few values of one variable, a line for each. Else, as of a single run, the extremes of each column, and the
  /// values at which they occur. "" without results.
  std::string text() const { return ends_.empty() ? "" : is_table_ ? table() : extremes(); }

 private:
  static constexpr long kMostListed = 20;  // runs

  std::string table() const {
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

  std::string extremes() const {
    std::vector<ColumnEnds> all = ends_;
    for (ColumnEnds& c : all) {
      c.at_least = " (" + setting_text(plan_.shown, plan_.grid.at(static_cast<long>(c.t_least))) + ")";
      c.at_most = " (" + setting_text(plan_.shown, plan_.grid.at(static_cast<long>(c.t_most))) + ")";
    }
    drop_rounding(all, plan_.loaded.scene.run.tolerance.relative);
    return results_text(all, "in the table");
  }

  const SweepPlan& plan_;
  const bool is_table_;
  std::vector<std::pair<long, std::vector<ColumnRange>>> runs_{};  // of a table; empty of a failed one
  std::vector<ColumnEnds> ends_{};  // over all runs, with their numbers in place of times
};

}  // namespace lockstep
