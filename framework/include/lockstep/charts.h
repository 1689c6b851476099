// Charts: curves, maps and bars, drawn by gnuplot as SVG and PNG beside each other.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/recorder.h>

namespace lockstep {

/// band: broad and pale, for what lies under other curves; crosses: points that failed.
enum class SeriesStyle { lines, dashes, points, linespoints, band, crosses };

/// One curve of a chart.
struct Series {
  std::string label;         ///< in the legend; "": not there
  std::vector<double> x, y;  ///< of equal length; what is not finite makes a gap
  SeriesStyle style = SeriesStyle::lines;
  std::string color{};  ///< "#rrggbb"; "": the next one that every eye can tell from the others
};

/// A text at a place of the panel, in the axes' own numbers.
struct Note {
  double x = 0, y = 0;
  std::string text;
};

using Range = std::pair<double, double>;

/// One pair of axes of a chart, with its curves.
struct Panel {
  std::string y_label;
  std::vector<Series> series;
  bool log_y = false;
  std::vector<Note> notes{};
  std::optional<Range> y_range{};
};

/// Panels under one another with one x axis in common.
struct ChartSpec {
  std::string title, x_label;
  std::vector<Panel> panels;
  bool log_x = false;
  std::optional<Range> x_range{};
  int width = 1000, height = 700;  ///< pixels
};

/// Column `y` over column `x`; the label is `label`, or the column's title "y [unit]".
LOCKSTEP_API Series curve(const Table&, const std::string& x, const std::string& y, const std::string& label = {});

/// Cells of a grid, each of one kind (works, inaccurate, fails) or of one value, with curves of a theory over them.
struct MapSpec {
  std::string title, x_label, y_label;
  std::vector<double> x, y;           ///< centres of the columns and of the rows, both rising
  bool log_x = false, log_y = false;  ///< centres evenly spaced in the logarithm
  std::vector<double> cells;          ///< row after row from the lowest y: number of the kind, or value; NaN: empty
  /// A colour of a map and what it stands for.
  struct Kind {
    std::string label, color;  ///< color "": green, amber, red, then grey
  };
  std::vector<Kind> kinds{};  ///< empty: cells are values, shown with a colour scale
  std::string value_label{};  ///< of the colour scale
  bool log_value = false;
  std::vector<Series> curves{};
  std::vector<Note> notes{};
  int width = 1000, height = 700;
};

/// Bars side by side, one group a category, with their numbers written on them.
struct BarSpec {
  std::string title, y_label;
  std::vector<std::string> categories;
  /// Bars that are drawn side by side.
  struct Group {
    std::string label;
    std::vector<double> values;  ///< one a category
    std::string color{};
  };
  std::vector<Group> groups;
  bool log_y = false;
  int width = 1000, height = 700;
};

/// Write `<base>.svg` and `<base>.png`, whichever of the two endings `path` has, or none. Throw ModelError for a
/// spec without anything to draw or with lengths that differ, FileError where gnuplot or a file fails.
LOCKSTEP_API void write_chart(const std::string& path, const ChartSpec&);
LOCKSTEP_API void write_map(const std::string& path, const MapSpec&);
/// Maps under one another, each below its own title.
LOCKSTEP_API void write_maps(const std::string& path, const std::string& title, const std::vector<MapSpec>&, int width,
                             int height);
LOCKSTEP_API void write_bars(const std::string& path, const BarSpec&);

}  // namespace lockstep
