// Grids: log-log panels beside and under one another, one legend for all of them above, remarks below.
#pragma once

#include <string>
#include <vector>

#include <lockstep/charts.h>

namespace lockstep {

/// Both axes logarithmic, both its own.
struct GridPanel {
  std::string title, x_label;
  std::vector<Series> series;
  double strip_from = 0;  ///< what lies above this y stands in a shaded strip with a name of its own; 0: no strip
  Range y_range{0, 0};    ///< {0, 0}: what is there
};

/// Series of one label have one colour and one mark in all panels, and one entry in the legend.
struct GridSpec {
  std::string title;
  std::size_t n_columns = 2;
  std::vector<GridPanel> panels{};
  std::string strip_label{};             ///< "failed"
  std::vector<std::string> remarks{};    ///< lines of text below
  int width = 1300, panel_height = 400;  ///< pixels
};

/// Write `<base>.svg` and `<base>.png` like write_chart, with the same errors.
LOCKSTEP_API void write_grid(const std::string& path, const GridSpec&);

}  // namespace lockstep
