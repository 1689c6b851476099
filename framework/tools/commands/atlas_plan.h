// SPDX-License-Identifier: BSD-3-Clause
// An atlas: two numbers of a scene that vary, the methods that have a map each, and how the maps are shown.
#pragma once

#include <string>
#include <vector>

#include <lockstep/table.h>
#include "framework/tools/charts/chart_grid.h"
#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/result.h"
#include "framework/tools/sweep/atlas_run.h"

namespace lockstep {

/// One map: a method over the whole grid.
struct AtlasPanel {
  MethodSpec integrator;
  Stabilization::Kind stabilization;
  bool adaptive = false;
  std::vector<AtlasCell> cells{};            ///< by the run of the grid, from 0
  std::vector<double> limit_x{}, limit_y{};  ///< the largest stable step by linear theory, along both axes
  std::string unsuited{};                    ///< why it is left out

  std::string name() const { return to_word(integrator) + ", " + to_string(stabilization); }
};

/// The axes, the maps and the limits.
struct AtlasPlan : VariedScene {
  std::vector<AtlasPanel> panels;
  AtlasLimits limits;
  double budget;

  /// What an axis is labelled with: "run.step [s]".
  std::string title(std::size_t axis) const { return column_title({variables[axis].path, variables[axis].unit, {}}); }
  /// The scene of a run of the grid with the method of a map.
  Scene scene(long run, const AtlasPanel& panel) const;
  /// Runs with equal keys have one reference: settings of the run, except its end, do not change it.
  std::string reference_key(long run) const;
};

/// Reads what varies, the methods and the limits. Throws UsageError for axes that make no map, SceneError.
AtlasPlan make_atlas_plan(const Arguments&);

/// The values of an axis. Throws UsageError if they are no numbers, fewer than two, or not rising.
std::vector<double> axis_numbers(const Variable&);

/// As CSV: a line for each run.
std::string atlas_csv(const AtlasPlan&);
/// "axes", and "maps": for each method its outcomes by the numbers of the axes, or why it is left out.
const Fields<AtlasPlan>& atlas_fields();
/// A map for each method that runs. `of`: "status", "error" or "energy"; `reference`: the methods of the references.
MapGridSpec atlas_picture(const AtlasPlan&, const std::string& reference, const std::string& of);

}  // namespace lockstep
