// SPDX-License-Identifier: BSD-3-Clause
// What varies, and what a sweep is to do with it.
#pragma once

#include <string>
#include <vector>

#include <lockstep/analysis.h>
#include <lockstep/sweep.h>
#include "framework/tools/program/commands.h"

namespace lockstep {

/// A scene with values that vary; it refers to the arguments.
struct VariedScene {
  const Arguments& arguments;
  Loaded loaded;
  std::vector<Variable> variables, shown;  ///< in SI units; in the units of --vary
  Grid grid;

  /// The scene of a run of the grid, from 1, with the settings of the command line.
  Scene scene(long run) const;
};
/// Reads the scene and --vary. Throws UsageError, also if a setting that varies is given by an option, too.
VariedScene read_varied(const Arguments&);
/// The same with ranges NAME=a:b, of which the values are the two ends. Warns of lengths that are given elsewhere too.
VariedScene read_ranges(const Arguments&);
/// The scene, and the numbers that --to names. Throws UsageError.
VariedScene read_numbers(const Arguments&);

/// What all runs of a sweep share.
struct SweepPlan : VariedScene {
  Shard shard{};
  Table columns{};  ///< of each run, without rows; with plain headers without units
  bool plain_headers = false;

  /// "run 2 (crank = 100 mm)", "12 runs (crank = 100 ... 150 mm)".
  std::string runs_text(const std::vector<long>& runs) const;
};

/// Throws UsageError, and SceneError if no run can be built. Warns of lengths that are given elsewhere too.
SweepPlan make_sweep_plan(const Arguments&);

/// Whether the report shows each run by itself.
bool keeps_motion(const Arguments&);

}  // namespace lockstep
