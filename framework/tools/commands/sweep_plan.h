// SPDX-License-Identifier: BSD-3-Clause
// What a sweep is to do: its variables, the grid of their values, and the columns of its runs.
#pragma once

#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// What all runs share.
struct SweepPlan {
  const Arguments& arguments;
  Loaded loaded;
  std::vector<Variable> variables;
  Grid grid;
  Shard shard;
  Table columns;  ///< of each run, without rows; with plain headers without units
  bool plain_headers;

  Scene scene(long run) const;
  /// "run 2 (crank = 0.1 m)", "12 runs (crank = 0.1 ... 0.15 m)".
  std::string runs_text(const std::vector<long>& runs) const;
};

/// Throws UsageError if a setting that varies is given by an option, too.
void refuse_varied_options(const Arguments&, const std::vector<Variable>&);
/// Throws UsageError, and SceneError if no run can be built. Warns of lengths that are given elsewhere too.
SweepPlan make_sweep_plan(const Arguments&);

/// Whether the report shows each run by itself.
bool keeps_motion(const Arguments&);
/// Why runs are made one by one, by the first run of the grid; "" if they are vectorised.
std::string why_alone(const SweepPlan&);

}  // namespace lockstep
