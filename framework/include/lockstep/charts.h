// SPDX-License-Identifier: BSD-3-Clause
// Charts: curves, maps and bars, drawn by gnuplot as SVG and PNG.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/recorder.h>

namespace lockstep {

/// How a curve is drawn.
enum class SeriesStyle {
  lines,        ///< a line
  dashes,       ///< a dashed line
  points,       ///< marks alone
  linespoints,  ///< a line with marks
  band,         ///< a broad line, under other curves
  crosses,      ///< crosses alone, for points that failed
  rings         ///< hollow points alone, for points that do not count
};

/// One curve of a chart.
struct Series {
  std::string label;                       ///< in the legend; "": no entry
  std::vector<double> x,                   ///< numbers of the x axis; a value that is not finite makes a gap
      y;                                   ///< numbers of the y axis, as many
  SeriesStyle style = SeriesStyle::lines;  ///< how it is drawn
  std::string color{};                     ///< "#rrggbb"; "": the next of a palette for the colour-blind
};

/// A text with a point, at a place given in the numbers of the axes.
struct Note {
  double x = 0,      ///< of the point
      y = 0;         ///< of the point
  std::string text;  ///< to the right of the point
};

using Range = std::pair<double, double>;  ///< from, to

/// One pair of axes of a chart, with its curves.
struct Panel {
  std::string y_label;             ///< of the y axis, with the unit
  std::vector<Series> series;      ///< its curves
  bool log_y = false;              ///< logarithmic y axis; numbers up to 0 are not drawn
  std::vector<Note> notes{};       ///< texts in it
  std::optional<Range> y_range{};  ///< of the y axis; none: all curves fit
};

/// Panels under one another with a common x axis.
struct ChartSpec {
  std::string title,               ///< above the panels; "": none
      x_label;                     ///< of the x axis, with the unit
  std::vector<Panel> panels;       ///< from top to bottom, at least one
  bool log_x = false;              ///< logarithmic x axis; numbers up to 0 are not drawn
  std::optional<Range> x_range{};  ///< of the x axis; none: all curves fit
  int width = 1000,                ///< of the picture, pixels
      height = 700;                ///< of the picture, pixels
};

/// Curve of column `y` over column `x`; its label is `label`, or the title of the column, "y [unit]". Throws ModelError
/// for an unknown column.
LOCKSTEP_API Series table_series(const Table&, const std::string& x, const std::string& y,
                                 const std::string& label = {});

/// A map: cells of a grid, each of one kind (accurate, wrong, failed) or with one value, and curves over them.
struct MapSpec {
  std::string title,          ///< above the map; "": none
      x_label,                ///< of the x axis, with the unit
      y_label;                ///< of the y axis, with the unit
  std::vector<double> x,      ///< centres of the columns of cells, at least two, rising
      y;                      ///< centres of the rows of cells, at least two, rising
  bool log_x = false,         ///< logarithmic x axis
      log_y = false;          ///< logarithmic y axis
  std::vector<double> cells;  ///< row after row from the lowest y: number of the kind, or value; NaN: empty
  /// A colour of a map and its meaning.
  struct Kind {
    std::string label,  ///< in the legend
        color;          ///< "#rrggbb"; "": by its number green, amber, red, then grey
  };
  std::vector<Kind> kinds{};     ///< empty: cells are values, shown with a colour scale
  std::string value_label{};     ///< of the colour scale
  bool log_value = false;        ///< logarithmic colour scale
  std::vector<Series> curves{};  ///< drawn over the cells, black if they have no colour
  std::vector<Note> notes{};     ///< texts in the map
  int width = 1000,              ///< of the picture, pixels
      height = 700;              ///< of the picture, pixels
};

/// Bars: for each category one bar of every group, side by side, with its number written on it.
struct BarSpec {
  std::string title,                    ///< above the bars; "": none
      y_label;                          ///< of the y axis, with the unit
  std::vector<std::string> categories;  ///< from left to right
  /// Bars of one colour, one per category.
  struct Group {
    std::string label;           ///< in the legend
    std::vector<double> values;  ///< one per category
    std::string color{};         ///< as Series::color
  };
  std::vector<Group> groups;  ///< from left to right in each category
  bool log_y = false;         ///< logarithmic y axis
  int width = 1000,           ///< of the picture, pixels
      height = 700;           ///< of the picture, pixels
};

/// Draws a chart as `<base>.svg` and `<base>.png`, where `path` is the base with either ending or none. Throws
/// ModelError for a chart without curves or with different lengths, FileError if gnuplot or a file fails.
LOCKSTEP_API void write_chart(const std::string& path, const ChartSpec&);
/// Draws a map. Files and errors as write_chart(), and ModelError for centres that do not rise.
LOCKSTEP_API void write_map(const std::string& path, const MapSpec&);
/// Draws maps under one another, each below its own title, in one picture of `width` x `height` pixels. Files and
/// errors as write_map().
LOCKSTEP_API void write_maps(const std::string& path, const std::string& title, const std::vector<MapSpec>&, int width,
                             int height);
/// Draws bars. Files and errors as write_chart().
LOCKSTEP_API void write_bars(const std::string& path, const BarSpec&);

}  // namespace lockstep
