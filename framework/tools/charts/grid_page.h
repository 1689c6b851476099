// SPDX-License-Identifier: BSD-3-Clause
// Plots in rows and columns on one page. Private to the chart_*.cpp files.
#pragma once

#include <string>
#include <vector>

#include "framework/tools/charts/gnuplot.h"

namespace lockstep {

/// A page with a title, a legend, plots of one size in rows and columns, and remarks, from top to bottom. Pixels.
class GridPage {
 public:
  /// Room around a plot; above it is its title.
  struct Edges {
    double above, below, left, between;
  };
  GridPage(const std::string& title, const std::vector<std::string>& remarks, std::size_t n_plots,
           std::size_t n_columns, std::size_t n_legend_rows, int width, int cell_height, const Edges&);

  /// Begins it with the entries of a legend, `maxcols` side by side with `letters` added to each.
  void begin(Script&, std::vector<std::string> entries, std::size_t maxcols, double letters) const;
  /// Margins of the next plot, the k-th row by row.
  void place(Script&, std::size_t k) const;
  /// Ends it with the remarks, and draws it.
  void draw_to(const std::string& path, Script&) const;
  static double inner_width(int width, const Edges&);  ///< what the legend may take

 private:
  void whole(Script&) const;

  const std::string& title_;
  const std::vector<std::string>& remarks_;
  Edges edges_;
  std::size_t n_columns_;
  double width_, cell_height_, legend_, top_, height_, plot_width_;  // legend_, top_: where it and the plots begin
};

}  // namespace lockstep
