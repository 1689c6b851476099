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

/// A map: cells of a grid, each of one kind (accurate, wrong, failed), and curves over them.
struct MapSpec {
  std::string title,          ///< above the map; "": none
      x_label,                ///< of the x axis, with the unit
      y_label;                ///< of the y axis, with the unit
  std::vector<double> x,      ///< centres of the columns of cells, at least two, rising
      y;                      ///< centres of the rows of cells, at least two, rising
  bool log_x = false,         ///< logarithmic x axis
      log_y = false;          ///< logarithmic y axis
  std::vector<double> cells;  ///< row after row from the lowest y: number of the kind; NaN: empty
  /// A colour of a map and its meaning.
  struct Kind {
    std::string label,  ///< in the legend
        color;          ///< "#rrggbb"
  };
  std::vector<Kind> kinds{};
  std::vector<Series> curves{};  ///< drawn over the cells, black if they have no colour
};

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

/// Writes `<base>.svg` and `<base>.png` as write_chart does. There is at least one map; x and y have two or more
/// rising centres, and each pair has a finite kind.
LOCKSTEP_API void write_map_grid(const std::string& path, const MapGridSpec&);

}  // namespace lockstep
