// What all charts look alike in; for the chart_*.cpp files only.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/charts.h>
#include "framework/tools/charts/gnuplot.h"

namespace lockstep::chart_style {

/// The n-th of the colours that remain apart for colour-blind eyes.
std::string color(std::size_t n);
/// `wanted` when it is "#rrggbb", else ModelError naming `what`; the n-th colour for "".
std::string color_or(const std::string& wanted, std::size_t n, const std::string& what);
/// Fonts, grid, borders, legend above the picture.
void common(Script&);
/// Begins a page of n panels under one another with its title, above the legend; `end_page` ends it.
void begin_page(Script&, std::size_t n, const std::string& title);
void end_page(Script&);
/// Label, logarithm, range of axis 'x' or 'y'; `low` and `high`: what is to be seen, for a choice of ticks.
void axis(Script&, char axis, const std::string& label, bool log, double low, double high);
void notes(Script&, const std::vector<Note>&);
/// Data block `$name` of the series, thinned to what a picture can show.
void series_data(Script&, const std::string& name, const Series&);
/// "$name using 1:2 with lines ...", n-th colour.
std::string plot_clause(const std::string& name, const Series&, std::size_t n);
/// Throws ModelError: lengths differ.
void check(const Series&, const std::string& chart);

/// Least and largest number that can be drawn on an axis.
struct Extent {
  double low, high;
  bool any = false;
  void take(std::span<const double> values, bool log);
};

}  // namespace lockstep::chart_style
