// SPDX-License-Identifier: BSD-3-Clause
// Maps.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/tools/charts/chart_grid.h"
#include "framework/tools/charts/chart_style.h"
#include "framework/tools/charts/grid_page.h"

namespace lockstep {
namespace {
using namespace chart_style;

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

bool is_kind(double cell, std::size_t kind) {
  return std::isfinite(cell) && std::lround(cell) == static_cast<long>(kind);
}

bool has_kind(const MapSpec& spec, std::size_t kind) {
  return std::ranges::any_of(spec.cells, [&](double cell) { return is_kind(cell, kind); });
}

std::string tint(const std::vector<MapSpec::Kind>& kinds, std::size_t k) {
  return color_or(kinds[k].color, k, "kind \"" + kinds[k].label + "\"");
}

// Cells of one kind as boxes: x, y, x low, x high, y low, y high.
void add_map(Script& out, const MapSpec& spec) {
  const std::vector<double> ex = edges(spec.x, spec.log_x), ey = edges(spec.y, spec.log_y);
  std::vector<std::string> clauses;
  for (std::size_t k = 0; k < spec.kinds.size(); ++k) {
    if (!has_kind(spec, k)) continue;
    const std::string name = fmt::format("kind{}", k);
    out.begin_data(name);
    for (std::size_t j = 0; j < spec.y.size(); ++j)
      for (std::size_t i = 0; i < spec.x.size(); ++i) {
        const double row[] = {spec.x[i], spec.y[j], ex[i], ex[i + 1], ey[j], ey[j + 1]};
        if (is_kind(spec.cells[j * spec.x.size() + i], k)) out.row(row);
      }
    out.end_data();
    clauses.push_back(
        fmt::format("${} using 1:2:3:4:5:6 with boxxyerror lc rgb '{}' fs solid 0.85 border lc rgb '#ffffff' notitle",
                    name, tint(spec.kinds, k)));
  }
  axis(out, 'x', spec.x_label, spec.log_x, ex.front(), ex.back());
  axis(out, 'y', spec.y_label, spec.log_y, ey.front(), ey.back());
  ranges(out, {ex.front(), ex.back()}, {ey.front(), ey.back()});
  out.line("set grid front lc rgb '#ffffff' lw 0.3");
  for (std::size_t i = 0; i < spec.curves.size(); ++i) {
    const std::string name = fmt::format("curve{}", i);
    Series s = spec.curves[i];
    s.label.clear();
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
    if (std::ranges::any_of(spec.maps, [&](const MapSpec& map) { return has_kind(map, k); }))
      entries.push_back(fmt::format("keyentry with boxes lc rgb '{}' fs solid 0.85 title {}", tint(kinds, k),
                                    quoted_text(kinds[k].label)));
  if (!spec.curve_label.empty())
    entries.push_back(
        fmt::format("keyentry with lines lc rgb '#111111' lw 2.4 title {}", quoted_text(spec.curve_label)));
  if (!spec.mark_label.empty())
    entries.push_back(
        fmt::format("keyentry with points pt 2 ps 0.8 lw 1.8 lc rgb '#111111' title {}", quoted_text(spec.mark_label)));
  return entries;
}

}  // namespace

void write_map_grid(const std::string& path, const MapGridSpec& spec) {
  const std::size_t n_columns = spec.maps.size() > 1 ? 2 : 1;  // labels are long
  const std::vector<std::string> entries = legend_entries(spec);
  const GridPage page(spec.title, spec.remarks, spec.maps.size(), spec.n_columns,
                      (entries.size() + n_columns - 1) / n_columns, spec.width, spec.map_height,
                      {.above = 40, .below = 74, .left = 92, .between = 108});
  Script out;
  page.begin(out, entries, n_columns, 2);
  for (std::size_t k = 0; k < spec.maps.size(); ++k) {
    page.place(out, k);
    out.line(fmt::format("set title {} noenhanced font ',13'", quoted_text(spec.maps[k].title)));
    out.line("set xtics nomirror out\nset ytics nomirror out");
    add_map(out, spec.maps[k]);
  }
  page.draw_to(path, out);
}

}  // namespace lockstep
