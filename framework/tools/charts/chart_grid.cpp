// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/charts/chart_grid.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/charts/chart_style.h"
#include "framework/tools/charts/grid_page.h"

namespace lockstep {
namespace {
using namespace chart_style;

constexpr GridPage::Edges kEdges{.above = 42, .below = 58, .left = 78, .between = 84};  // pixels

// The colours of chart_style and five more, which most readers can distinguish; marks and dashes do the rest.
constexpr std::array<const char*, 12> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
                                              "#000000", "#882255", "#999933", "#5b3fa0", "#8c564b", "#7f7f7f"};

struct Legend {
  std::vector<Series> entries;  // labels with their line styles and colours
  std::size_t n_columns = 1, n_rows = 0;
  double width = 0;  // letters added to each column: gnuplot underestimates their width
  bool rings = false;

  std::size_t index(const std::string& label) const {
    return static_cast<std::size_t>(std::ranges::find(entries, label, &Series::label) - entries.begin());
  }
};

// Series with a colour of their own come last, so that they do not shift the colours of the others.
Legend legend_of(const GridSpec& spec) {
  Legend legend;
  std::size_t longest = 0;
  for (const bool own_color : {false, true})
    for (const GridPanel& panel : spec.panels)
      for (const Series& s : panel.series) {
        if (s.label.empty() || s.color.empty() == own_color || legend.index(s.label) < legend.entries.size()) continue;
        const SeriesStyle style = own_color ? s.style : SeriesStyle::linespoints;
        legend.entries.push_back(
            {s.label, {}, {}, style, own_color ? s.color : kColors[legend.entries.size() % kColors.size()]});
        longest = std::max(longest, s.label.size());
      }
  for (const GridPanel& panel : spec.panels) legend.rings = legend.rings || !panel.open_ends.x.empty();
  if (legend.rings) longest = std::max(longest, spec.open_label.size());
  const double letters = static_cast<double>(longest);
  legend.width = 1 + 0.25 * letters;  // added to the letters by gnuplot
  const std::size_t fits = legend_columns(GridPage::inner_width(spec.width, kEdges), letters + legend.width, 9);
  const std::size_t n = legend.entries.size() + (legend.rings ? 1 : 0);
  legend.n_rows = (n + fits - 1) / fits;
  legend.n_columns = legend.n_rows > 0 ? (n + legend.n_rows - 1) / legend.n_rows : 1;
  return legend;
}

constexpr const char* kRings = "with points pt 6 ps 2.2 lw 1.6 lc rgb '#555555'";

std::vector<std::string> legend_entries(const GridSpec& spec, const Legend& legend) {
  std::vector<std::string> entries;
  for (std::size_t i = 0; i < legend.entries.size(); ++i) {
    std::string entry = plot_clause("none", legend.entries[i], i);
    entry.replace(0, std::string("$none using 1:2").size(), "keyentry");
    entries.push_back(entry);
  }
  if (legend.rings) entries.push_back(fmt::format("keyentry {} title {}", kRings, quoted_text(spec.open_label)));
  return entries;
}

// Whole decades around what is there, so that every axis has labels.
Range decades(const Extent& e, double room) { return {e.low / std::pow(10.0, room), e.high * std::pow(10.0, room)}; }

void strip(Script& out, const GridPanel& panel, const std::string& name) {
  out.line("unset object\nunset label");
  out.line(fmt::format("set label 1 {} at graph 0,1 left offset 0,0.9 noenhanced font ',13' textcolor rgb '#111111'",
                       quoted_text(panel.title)));
  if (panel.strip_from <= 0) return;
  out.line(
      fmt::format("set object 1 rectangle from graph 0, first {} to graph 1, graph 1 behind fc rgb '#eeeeee' fs "
                  "solid noborder",
                  panel.strip_from));
  out.line(
      fmt::format("set label 2 {} at graph 1, graph 1 right offset 0,0.8 noenhanced font ',10' textcolor rgb "
                  "'#777777'",
                  quoted_text(name)));
}

void add_panel(Script& out, const GridSpec& spec, const Legend& legend, std::size_t k) {
  const GridPanel& panel = spec.panels[k];
  const Extent x = extent_of(panel.series, &Series::x, true), y = extent_of(panel.series, &Series::y, true);
  axis(out, 'x', panel.x_label, true, x.low, x.high);
  axis(out, 'y', "", true, y.low, y.high);
  out.line("set xtics nomirror out\nset ytics nomirror out");
  ranges(out, decades(x, 0.08), panel.y_range.second > 0 ? panel.y_range : decades(y, 0.15));
  strip(out, panel, spec.strip_label);
  std::vector<std::string> clauses;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    Series s = panel.series[i];
    const std::size_t n = s.label.empty() ? i : legend.index(s.label);
    if (!s.label.empty()) s.color = color_or(legend.entries[n].color, n, "series \"" + s.label + "\"");
    s.label.clear();
    clauses.push_back(plot_clause(block_name(k, i), s, n));
  }
  if (!panel.open_ends.x.empty()) {
    series_data(out, "open", panel.open_ends);
    clauses.push_back(fmt::format("$open using 1:2 {} notitle", kRings));
  }
  plot(out, clauses);
}

void check(const GridSpec& spec) {
  if (spec.panels.empty()) throw ModelError(fmt::format("chart \"{}\" has no panels; give it one", spec.title));
  for (const GridPanel& panel : spec.panels)
    chart_style::check(panel.open_ends, spec.title),
        check_panel(panel.series, true, true, spec.title, panel.title, "numbers above zero");
}

}  // namespace

void write_grid(const std::string& path, const GridSpec& spec) {
  check(spec);
  const Legend legend = legend_of(spec);
  const GridPage page(spec.title, spec.remarks, spec.panels.size(), spec.n_columns, legend.n_rows, spec.width,
                      spec.panel_height, kEdges);
  Script out;
  panel_data(out, spec.panels);
  page.begin(out, legend_entries(spec, legend), legend.n_columns, legend.width);
  for (std::size_t k = 0; k < spec.panels.size(); ++k) {
    page.place(out, k);
    add_panel(out, spec, legend, k);
  }
  page.draw_to(path, out);
}

}  // namespace lockstep
