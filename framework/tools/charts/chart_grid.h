// SPDX-License-Identifier: BSD-3-Clause
// Grids of log-log panels, with one legend above and remarks below.
#pragma once

#include <string>
#include <vector>

#include <lockstep/charts.h>

namespace lockstep {

/// A panel with its own logarithmic axes.
struct GridPanel {
  std::string title, x_label;
  std::vector<Series> series;
  double strip_from = 0;  ///< above this y the panel is a shaded strip; 0: no strip
  Range y_range{0, 0};    ///< {0, 0}: that of the data
  Series open_ends{};     ///< points with a ring: ends of curves that could continue
};

/// Series of one label have one colour and one mark in all panels, and one entry in the legend.
struct GridSpec {
  std::string title;
  std::size_t n_columns = 2;
  std::vector<GridPanel> panels{};
  std::string strip_label{};             ///< "failed"
  std::string open_label{};              ///< of the rings, in the legend: "finer settings not tried"
  std::vector<std::string> remarks{};    ///< lines of text below
  int width = 1300, panel_height = 400;  ///< pixels
};

/// Writes `<base>.svg` and `<base>.png` as write_chart does, with the same errors.
LOCKSTEP_API void write_grid(const std::string& path, const GridSpec&);

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
