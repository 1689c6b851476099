// SPDX-License-Identifier: BSD-3-Clause
// Maps and bars.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/charts/chart_grid.h"
#include "framework/tools/charts/chart_style.h"
#include "framework/tools/charts/grid_page.h"

namespace lockstep {
namespace {
using namespace chart_style;

constexpr const char* kKindColors[] = {"#2a9d6f", "#f2c14e", "#c8443c", "#b0b0b0"};

void check(const MapSpec& spec) {
  if (spec.x.size() < 2 || spec.y.size() < 2)
    throw ModelError(fmt::format("map \"{}\": {} columns and {} rows; it needs at least two of each", spec.title,
                                 spec.x.size(), spec.y.size()));
  if (spec.cells.size() != spec.x.size() * spec.y.size())
    throw ModelError(fmt::format("map \"{}\": {} cells for {} x {} centres; give one per centre, row after row",
                                 spec.title, spec.cells.size(), spec.x.size(), spec.y.size()));
  const auto rising = [&](const std::vector<double>& c, bool log, char a) {
    if (std::adjacent_find(c.begin(), c.end(), std::greater_equal<>()) != c.end() || (log && c.front() <= 0))
      throw ModelError(
          fmt::format("map \"{}\": the centres along {} must rise{}", spec.title, a, log ? " from above zero" : ""));
  };
  rising(spec.x, spec.log_x, 'x');
  rising(spec.y, spec.log_y, 'y');
  Extent seen{};
  seen.take(spec.cells, spec.kinds.empty() && spec.log_value);
  if (!seen.any) throw ModelError(fmt::format("map \"{}\" has no cell to draw; give it numbers", spec.title));
  if (!spec.kinds.empty() && (seen.low < 0 || seen.high > static_cast<double>(spec.kinds.size()) - 1))
    throw ModelError(fmt::format("map \"{}\": a cell of kind {}, but the kinds are 0 to {}", spec.title,
                                 seen.low < 0 ? seen.low : seen.high, spec.kinds.size() - 1));
  for (const Series& s : spec.curves) chart_style::check(s, spec.title);
}

// Half way to the neighbours, in the logarithm on a logarithmic axis; the outer edges mirror the inner ones.
std::vector<double> edges(std::vector<double> c, bool log) {
  std::vector<double> e;
  for (double& v : c) v = log ? std::log(v) : v;
  e.push_back(c[0] - 0.5 * (c[1] - c[0]));
  for (std::size_t i = 1; i < c.size(); ++i) e.push_back(0.5 * (c[i - 1] + c[i]));
  e.push_back(c.back() + (c.back() - e.back()));
  for (double& v : e) v = log ? std::exp(v) : v;
  return e;
}

// Cells as boxes: x, y, x low, x high, y low, y high, value. One block per kind, each with its own legend entry.
void cell_data(Script& out, const std::string& name, const MapSpec& spec, int kind) {
  const std::vector<double> ex = edges(spec.x, spec.log_x), ey = edges(spec.y, spec.log_y);
  out.begin_data(name);
  for (std::size_t j = 0; j < spec.y.size(); ++j)
    for (std::size_t i = 0; i < spec.x.size(); ++i) {
      const double value = spec.cells[j * spec.x.size() + i];
      const bool shown = std::isfinite(value) && (kind < 0 || std::lround(value) == kind);
      const double row[] = {spec.x[i], spec.y[j], ex[i], ex[i + 1], ey[j], ey[j + 1], value};
      if (shown) out.row(row);
    }
  out.end_data();
}

bool has_kind(const MapSpec& spec, int kind) {
  return std::any_of(spec.cells.begin(), spec.cells.end(),
                     [&](double v) { return std::isfinite(v) && std::lround(v) == kind; });
}

std::vector<std::string> cell_clauses(Script& out, const MapSpec& spec) {
  std::vector<std::string> clauses;
  if (spec.kinds.empty()) {
    cell_data(out, "cells", spec, -1);
    clauses.push_back("$cells using 1:2:3:4:5:6:7 with boxxyerror lc palette fs solid 1 noborder notitle");
    out.line("set palette defined (0 '#fdfde3', 0.25 '#a8dba5', 0.5 '#3fa8a0', 0.75 '#28619b', 1 '#2a1b50')");
    out.line(fmt::format("set cblabel {} noenhanced", quoted_text(spec.value_label)));
    out.line(spec.log_value ? "set logscale cb; set format cb '10^{%T}'" : "unset logscale cb");
    out.line("set rmargin 14");
    return clauses;
  }
  for (std::size_t k = 0; k < spec.kinds.size(); ++k) {
    if (!has_kind(spec, static_cast<int>(k))) continue;
    const std::string name = fmt::format("kind{}", k);
    cell_data(out, name, spec, static_cast<int>(k));
    const MapSpec::Kind& kind = spec.kinds[k];
    const std::string fallback = kKindColors[std::min<std::size_t>(k, 3)];
    const std::string tint = color_or(kind.color.empty() ? fallback : kind.color, 0, "kind \"" + kind.label + "\"");
    clauses.push_back(
        fmt::format("${} using 1:2:3:4:5:6 with boxxyerror lc rgb '{}' fs solid 0.85 border lc rgb '#ffffff' title {}",
                    name, tint, quoted_text(kind.label)));
  }
  return clauses;
}

void add_map(Script& out, const MapSpec& spec) {
  std::vector<std::string> clauses = cell_clauses(out, spec);
  const std::vector<double> ex = edges(spec.x, spec.log_x), ey = edges(spec.y, spec.log_y);
  axis(out, 'x', spec.x_label, spec.log_x, ex.front(), ex.back());
  axis(out, 'y', spec.y_label, spec.log_y, ey.front(), ey.back());
  ranges(out, {ex.front(), ex.back()}, {ey.front(), ey.back()});
  out.line("set grid front lc rgb '#ffffff' lw 0.3");
  notes(out, spec.notes);
  for (std::size_t i = 0; i < spec.curves.size(); ++i) {
    const std::string name = fmt::format("curve{}", i);
    Series s = spec.curves[i];
    if (s.color.empty()) s.color = "#111111";
    series_data(out, name, s);
    clauses.push_back(plot_clause(name, s, i));
  }
  plot(out, clauses);
}

std::vector<std::string> legend_entries(const MapGridSpec& spec) {
  std::vector<std::string> entries;
  const std::vector<MapSpec::Kind>& kinds = spec.maps.front().kinds;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (std::ranges::any_of(spec.maps, [&](const MapSpec& map) { return has_kind(map, static_cast<int>(k)); }))
      entries.push_back(fmt::format("keyentry with boxes lc rgb '{}' fs solid 0.85 title {}",
                                    color_or(kinds[k].color, k, "kind \"" + kinds[k].label + "\""),
                                    quoted_text(kinds[k].label)));
  if (!spec.curve_label.empty())
    entries.push_back(
        fmt::format("keyentry with lines lc rgb '#111111' lw 2.4 title {}", quoted_text(spec.curve_label)));
  if (!spec.mark_label.empty())
    entries.push_back(
        fmt::format("keyentry with points pt 2 ps 0.8 lw 1.8 lc rgb '#111111' title {}", quoted_text(spec.mark_label)));
  return entries;
}

Extent checked(const BarSpec& spec) {
  Extent y{};
  for (const BarSpec::Group& g : spec.groups) {
    if (g.values.size() != spec.categories.size())
      throw ModelError(fmt::format("bars \"{}\": group \"{}\" has {} values for {} categories; give one each",
                                   spec.title, g.label, g.values.size(), spec.categories.size()));
    y.take(g.values, spec.log_y);
  }
  if (!y.any) throw ModelError(fmt::format("bars \"{}\" have nothing to draw; give them numbers", spec.title));
  return y;
}

}  // namespace

void write_map(const std::string& path, const MapSpec& spec) {
  check(spec);
  Script out;
  begin_page(out, 1, spec.title);
  add_map(out, spec);
  draw_page(out, path, spec.width, spec.height);
}

void write_maps(const std::string& path, const std::string& title, const std::vector<MapSpec>& specs, int width,
                int height) {
  if (specs.empty()) throw ModelError(fmt::format("\"{}\" has no maps; give it at least one", title));
  for (const MapSpec& spec : specs) check(spec);
  Script out;
  begin_page(out, specs.size(), title);
  for (const MapSpec& spec : specs) {
    out.line(fmt::format("set title {} noenhanced font ',13'", quoted_text(spec.title)));
    add_map(out, spec);
  }
  draw_page(out, path, width, height);
}

void write_map_grid(const std::string& path, const MapGridSpec& spec) {
  if (spec.maps.empty()) throw ModelError(fmt::format("\"{}\" has no maps; give it at least one", spec.title));
  for (const MapSpec& map : spec.maps) check(map);
  const std::size_t n_columns = spec.maps.size() > 1 ? 2 : 1;  // labels are long
  const std::vector<std::string> entries = legend_entries(spec);
  const GridPage page(spec.title, spec.remarks, spec.maps.size(), spec.n_columns,
                      (entries.size() + n_columns - 1) / n_columns, spec.width, spec.map_height,
                      {.above = 40, .below = 74, .left = 92, .between = 108});
  Script out;
  page.begin(out, entries, n_columns, 2);
  for (std::size_t k = 0; k < spec.maps.size(); ++k) {
    page.place(out, k);
    MapSpec map = spec.maps[k];
    for (Series& s : map.curves) s.label.clear();
    out.line(fmt::format("set title {} noenhanced font ',13'", quoted_text(map.title)));
    out.line("set xtics nomirror out\nset ytics nomirror out");
    add_map(out, map);
  }
  page.draw_to(path, out);
}

void write_bars(const std::string& path, const BarSpec& spec) {
  const Extent y = checked(spec);
  Script out;
  begin_page(out, 1, spec.title);
  axis(out, 'y', spec.y_label, spec.log_y, y.low, y.high);
  out.line("set xtics scale 0 noenhanced\nset style fill solid 0.9 noborder\nunset grid\nset grid y");
  const double n = static_cast<double>(spec.groups.size()), width = 0.8 / n;
  std::string ticks;
  for (std::size_t c = 0; c < spec.categories.size(); ++c)
    ticks += fmt::format("{}{} {}", c == 0 ? "" : ", ", quoted_text(spec.categories[c]), c);
  out.line("set xtics (" + ticks + ")");
  std::size_t longest = 0;
  for (const std::string& c : spec.categories) longest = std::max(longest, c.size());
  const bool crowded = 8 * longest * spec.categories.size() > static_cast<std::size_t>(spec.width) - 150;
  out.line(crowded ? "set xtics rotate by -20" : "set xtics norotate");
  constexpr double kLeftOfBars = 104, kLegend = 30;  // pixels
  const double right = crowded ? 120 : 28, below = crowded ? 90 : 44;
  const double top = 1 - (title_height(spec.title) + kLegend) / spec.height;
  margins(out, kLeftOfBars / spec.width, 1 - right / spec.width, top, below / spec.height);
  out.line(
      fmt::format("set key at screen {:.5f}, screen {:.5f} left bottom horizontal", kLeftOfBars / spec.width, top));
  out.line(fmt::format("set xrange [-0.6:{}]", static_cast<double>(spec.categories.size()) - 0.4));
  std::size_t letters = 0;
  for (const BarSpec::Group& g : spec.groups)
    for (const double v : g.values) letters = std::max(letters, fmt::format("{:.4g}", v).size());
  const double pixels = (spec.width - kLeftOfBars - right) / static_cast<double>(spec.categories.size()) * width;
  const bool upright = 7.5 * static_cast<double>(letters) > pixels;  // wider than their bar
  if (spec.log_y)
    out.line(fmt::format("set yrange [{}:{}]", y.low / 3, y.high * 3 * (upright ? std::cbrt(y.high / y.low) : 1)));
  else
    out.line(fmt::format("set yrange [{}:{}]", std::min(0.0, y.low), upright ? fmt::format("{}", 1.15 * y.high) : "*"));
  const char* const stand = upright ? "rotate by 90 left offset 0,0.4" : "offset 0,0.6";
  std::vector<std::string> clauses;
  for (std::size_t g = 0; g < spec.groups.size(); ++g) {
    const std::string name = fmt::format("bar{}", g);
    out.begin_data(name);
    for (std::size_t c = 0; c < spec.categories.size(); ++c) {
      const double row[] = {static_cast<double>(c) + (static_cast<double>(g) - 0.5 * (n - 1)) * width,
                            spec.groups[g].values[c]};
      if (std::isfinite(row[1]) && (!spec.log_y || row[1] > 0)) out.row(row);
    }
    out.end_data();
    const std::string tint = color_or(spec.groups[g].color, g, "group \"" + spec.groups[g].label + "\"");
    const std::string legend = spec.groups[g].label.empty() ? "notitle" : "title " + quoted_text(spec.groups[g].label);
    clauses.push_back(fmt::format("${} using 1:2:({}) with boxes lc rgb '{}' {}", name, 0.94 * width, tint, legend));
    clauses.push_back(fmt::format("${} using 1:2:(sprintf('%.4g',$2)) with labels {} font ',10' notitle", name, stand));
  }
  plot(out, clauses);
  draw_page(out, path, spec.width, spec.height);
}

}  // namespace lockstep
