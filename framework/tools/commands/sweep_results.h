// SPDX-License-Identifier: BSD-3-Clause
// What a sweep prints of its results.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/program/run_words.h"

namespace lockstep {

/// The extremes of the recorded columns over the runs of a sweep. The plan must outlive it.
class SweepResults {
 public:
  explicit SweepResults(const SweepPlan&);
  void add(long run, const SweepRun&);
  /// Of few values of one variable, a line for each. Else, as of a single run, the extremes of each column, and the
  /// values at which they occur. "" without results.
  std::string text() const { return ends_.empty() ? "" : is_table_ ? table() : extremes(); }

 private:
  std::string table() const;
  std::string extremes() const;

  const SweepPlan& plan_;
  const bool is_table_;
  std::vector<std::pair<long, std::vector<ColumnRange>>> runs_{};  // of a table; empty of a failed one
  std::vector<ColumnEnds> ends_{};  // over all runs, with their numbers in place of times
};

}  // namespace lockstep
