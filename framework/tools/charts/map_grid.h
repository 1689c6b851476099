// SPDX-License-Identifier: BSD-3-Clause
// Maps side by side, with one legend above and remarks below.
#pragma once

#include <string>
#include <vector>

#include <lockstep/charts.h>

namespace lockstep {

/// All maps have the kinds of the first; their curves are drawn black, with one entry in the legend for lines and one for
/// crosses.
struct MapGridSpec {
  std::string title;
  std::size_t n_columns = 3;
  std::vector<MapSpec> maps{};
  std::string curve_label{},           ///< "": no entry
      mark_label{};                    ///< of crosses; "": no entry
  std::vector<std::string> remarks{};  ///< lines of text below
  int width = 1300, map_height = 360;  ///< pixels
};

/// Writes `<base>.svg` and `<base>.png` as write_map does, with the same errors.
LOCKSTEP_API void write_map_grid(const std::string& path, const MapGridSpec&);

}  // namespace lockstep
