// SPDX-License-Identifier: BSD-3-Clause
// The common style of all charts. Private to the chart_*.cpp files.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <lockstep/charts.h>
#include "framework/tools/charts/gnuplot.h"

namespace lockstep::chart_style {

/// `wanted` if it is "#rrggbb", the n-th of a palette for colour-blind readers for ""; else throws ModelError naming `what`.
LOCKSTEP_API std::string color_or(const std::string& wanted, std::size_t n, const std::string& what);
/// Begins a page of n panels, one below the other, with its title above the legend: fonts, grid, borders.
LOCKSTEP_API void begin_page(Script&, std::size_t n, const std::string& title);
/// Ends it, and draws it as draw() does.
LOCKSTEP_API void draw_page(Script&, const std::string& path, int width, int height);
/// Pixels that the title of a page takes: nothing, one line or two.
LOCKSTEP_API double title_height(const std::string& title);
/// Label, scale and ticks of axis 'x' or 'y'; `low` and `high`: the range shown.
LOCKSTEP_API void axis(Script&, char axis, const std::string& label, bool log, double low, double high);
LOCKSTEP_API void notes(Script&, const std::vector<Note>&);
/// Data block `$name` of the series, thinned to what a picture can show.
LOCKSTEP_API void series_data(Script&, const std::string& name, const Series&);
/// The name of the data block of one series of one panel, and all blocks of some panels.
LOCKSTEP_API std::string block_name(std::size_t panel, std::size_t series);
template <class P>
void panel_data(Script& out, const std::vector<P>& panels) {
  for (std::size_t k = 0; k < panels.size(); ++k)
    for (std::size_t i = 0; i < panels[k].series.size(); ++i) series_data(out, block_name(k, i), panels[k].series[i]);
}
/// One plot command of these clauses.
LOCKSTEP_API void plot(Script&, const std::vector<std::string>& clauses);
/// What the next plot shows along its axes.
LOCKSTEP_API void ranges(Script&, const Range& x, const Range& y);
/// Edges of the next plot, as fractions of the picture from its left and its lower edge.
LOCKSTEP_API void margins(Script&, double left, double right, double top, double bottom);
/// How many legend entries of `letters` letters fit side by side into `width` pixels.
LOCKSTEP_API std::size_t legend_columns(double width, double letters, double letter_width);
/// "$name using 1:2 with lines ...", n-th colour.
LOCKSTEP_API std::string plot_clause(const std::string& name, const Series&, std::size_t n);
/// Throws ModelError if x and y differ in length.
LOCKSTEP_API void check(const Series&, const std::string& chart);

/// Least and largest number that can be drawn on an axis.
struct LOCKSTEP_API Extent {
  double low, high;
  bool any = false;
  void take(std::span<const double> values, bool log);
};
/// Of x or y of several series.
LOCKSTEP_API Extent extent_of(const std::vector<Series>&, std::vector<double> Series::*part, bool log);
/// Throws ModelError if a panel has a bad series, or no number to draw; `advice` ends the message.
LOCKSTEP_API void check_panel(const std::vector<Series>&, bool log_x, bool log_y, const std::string& chart,
                              const std::string& panel, const std::string& advice);

}  // namespace lockstep::chart_style
