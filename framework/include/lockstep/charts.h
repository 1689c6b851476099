// SPDX-License-Identifier: BSD-3-Clause
// Charts of curves, drawn by gnuplot as SVG and PNG.
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

/// Draws a chart as `<base>.svg` and `<base>.png`, where `path` is the base with either ending or none. Throws
/// ModelError for a chart without curves or with different lengths, FileError if gnuplot or a file fails.
LOCKSTEP_API void write_chart(const std::string& path, const ChartSpec&);

}  // namespace lockstep
