// SPDX-License-Identifier: BSD-3-Clause
// Runs a scene from beginning to end, as the program does, and hands over what was recorded.
#pragma once

#include <functional>
#include <string>

#include <lockstep/dynamics.h>
#include <lockstep/recorder.h>
#include <lockstep/scene.h>

namespace lockstep {

struct SceneRun {
  Table table;
  SimulationReport report;
  WorkCount work;
  AssemblyReport assembly;
  int n_velocities = 0;
};

/// A scene of samples/scenes by its name: the path of its file.
std::string scene_path(const std::string& name);
/// A trusted history of tests/verification/data by its name.
Table trusted(const std::string& csv);

/// `change` may alter the run settings before the mechanism is built.
/// `describe` the scene itself.
SceneRun run_scene(const std::string& path, const std::function<void(RunSettings&)>& change = {},
                   const std::function<void(Scene&)>& describe = {});

/// Largest difference of a column from the trusted one over the whole history, and the column's size (its largest
/// trusted value).
struct ColumnError {
  std::string name;
  double error = 0;  ///< infinite when the columns are not equally long
  double size = 0;
};
/// Columns that both have, by name; the columns qw qx qy qz agree up to one common sign a row.
std::vector<ColumnError> compare(const Table& ours, const Table& trusted);

}  // namespace lockstep
