// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/charts.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/tools/charts/chart_path.h"
#include "framework/tools/charts/chart_style.h"

namespace lockstep {
namespace {
using namespace chart_style;

void check(const ChartSpec& spec) {
  if (spec.panels.empty())
    throw ModelError(fmt::format("chart \"{}\" has no panels; give it at least one", spec.title));
  for (const Panel& p : spec.panels)
    check_panel(
        p.series, spec.log_x, p.log_y, spec.title, p.y_label,
        std::string("a series with numbers") + (spec.log_x || p.log_y ? " above zero, or use linear axes" : ""));
}

void range(Script& out, char a, const std::optional<Range>& r) {
  if (r)
    out.line(fmt::format("set {}range [{}:{}]", a, r->first, r->second));
  else
    out.line(fmt::format("set {}range [*:*]{}", a, a == 'x' ? " noextend" : ""));
}

double size_of(const Extent& y) { return std::max(std::abs(y.low), std::abs(y.high)); }

bool is_constant(const Extent& y) { return !(y.high - y.low > 1e-5 * size_of(y)); }

// The range of the data and a twentieth of it above and below; around a constant, a twentieth of its size. None if
// that overflows.
std::optional<Range> with_margin(const Extent& y) {
  constexpr double kPart = 0.05;
  if (size_of(y) == 0) return Range{-1, 1};
  const double margin = kPart * (is_constant(y) ? size_of(y) : y.high - y.low);
  const Range r{y.low - margin, y.high + margin};
  return std::isfinite(r.first) && std::isfinite(r.second) ? std::optional(r) : std::nullopt;
}

constexpr double kLeft = 104, kRight = 28;  // pixels to the left and right of the panels

struct Legend {
  std::size_t n_columns, n_rows;
  double width;  ///< letters added to each column: gnuplot underestimates their width
};

Legend legend_of(const Panel& p, int picture_width) {
  std::size_t n = 0, longest = 0;
  for (const Series& s : p.series) {
    n += s.label.empty() ? 0 : 1;
    longest = std::max(longest, s.label.size());
  }
  const double letters = static_cast<double>(longest);
  const std::size_t columns = legend_columns(picture_width - kLeft - kRight, letters, 10);
  return {columns, (n + columns - 1) / columns, 1 + 0.3 * letters};
}

// Fractions of the picture, from its left and its lower edge.
struct Layout {
  double left, right, first_top, plot_height, pitch;
};

// Every panel has the same height, with room for the largest legend.
Layout layout_of(const ChartSpec& spec) {
  constexpr double kRow = 21, kGap = 12;
  std::size_t n_rows = 0;
  for (const Panel& p : spec.panels) n_rows = std::max(n_rows, legend_of(p, spec.width).n_rows);
  const double top = 6 + title_height(spec.title);
  const double bottom = spec.x_label.empty() ? 36 : 72;
  const double pitch = (spec.height - top - bottom + kGap) / static_cast<double>(spec.panels.size());
  const double legend = std::min(kRow * static_cast<double>(n_rows) + 6, 0.5 * pitch);
  const double plot = std::max(pitch - kGap - legend, 0.3 * pitch);
  return {kLeft / spec.width, 1 - kRight / spec.width, 1 - (top + legend) / spec.height, plot / spec.height,
          pitch / spec.height};
}

// Distance of the tics, 1, 2 or 5 times a power of ten: as many as fit the height, and at least two.
double tic_step(double low, double high, double height) {
  const double most = std::clamp(std::floor(height / 32), 2.0, 10.0);
  const double raw = (high - low) / most;
  if (!(raw > 0) || !std::isfinite(raw)) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double digit : {5.0, 2.0, 1.0, 0.5}) {
    const bool two_inside = std::floor(high / step) - std::ceil(low / step) >= 1;
    if (two_inside && digit * power < raw) break;
    step = digit * power;
  }
  return step;
}

void panel(Script& out, const ChartSpec& spec, const Layout& layout, std::size_t k) {
  const Panel& p = spec.panels[k];
  const Legend legend = legend_of(p, spec.width);
  const double top = layout.first_top - static_cast<double>(k) * layout.pitch;
  margins(out, layout.left, layout.right, top, top - layout.plot_height);
  out.line(fmt::format("set key at screen {:.5f}, screen {:.5f} left bottom horizontal maxcols {} width {}",
                       layout.left, top, legend.n_columns, legend.width));
  const bool last = k + 1 == spec.panels.size();
  Extent x{};
  for (const Panel& each : spec.panels)
    for (const Series& s : each.series) x.take(s.x, spec.log_x);
  const Extent y = extent_of(p.series, &Series::y, p.log_y);
  axis(out, 'x', last ? spec.x_label : "", spec.log_x, x.low, x.high);
  axis(out, 'y', "", p.log_y, y.low, y.high);
  if (!last) out.line("set format x ''");
  std::optional<Range> seen = p.y_range;
  if (!p.log_y) {
    if (!seen) seen = with_margin(y);
    const double step = seen ? tic_step(seen->first, seen->second, layout.plot_height * spec.height) : 0;
    out.line(step > 0 ? fmt::format("set ytics {}", step) : std::string("set ytics autofreq"));
  }
  range(out, 'x', spec.x_range);
  range(out, 'y', seen);
  notes(out, p.notes);
  out.line(
      fmt::format("set label {} at screen {:.5f}, graph 0.5 center rotate by 90 noenhanced textcolor rgb '#222222'",
                  quoted_text(p.y_label), layout.left / 8));  // gnuplot drops that of the axis beside wide tics
  std::vector<std::string> clauses;
  for (std::size_t i = 0; i < p.series.size(); ++i) clauses.push_back(plot_clause(block_name(k, i), p.series[i], i));
  plot(out, clauses);
}

// Widens the range that has more room, so that both axes have one scale: pixels per unit.
void equalize(Range& x, Range& y, double width, double height) {
  const double span = std::max((x.second - x.first) / width, (y.second - y.first) / height);
  const auto widen = [&](Range& r, double pixels) {
    const double middle = 0.5 * (r.first + r.second);
    r = {middle - 0.5 * span * pixels, middle + 0.5 * span * pixels};
  };
  widen(x, width), widen(y, height);
}

}  // namespace

Series table_series(const Table& table, const std::string& x, const std::string& y, const std::string& label) {
  return {label.empty() ? column_title(table.column(y)) : label, table[x], table[y]};
}

void write_chart(const std::string& path, const ChartSpec& spec) {
  check(spec);
  Script out;
  panel_data(out, spec.panels);
  begin_page(out, spec.panels.size(), spec.title);
  const Layout layout = layout_of(spec);
  for (std::size_t k = 0; k < spec.panels.size(); ++k) panel(out, spec, layout, k);
  draw_page(out, path, spec.width, spec.height);
}

void write_path(const std::string& path, const PathSpec& spec) {
  ChartSpec chart{spec.title, spec.x_label, {{spec.y_label, {{"", spec.x, spec.y}}}}};
  chart.width = spec.width, chart.height = spec.height;
  check(chart);
  Panel& panel = chart.panels.front();
  Extent x{}, y{};
  x.take(spec.x, false), y.take(spec.y, false);
  chart.x_range = with_margin(x), panel.y_range = with_margin(y);
  const Layout at = layout_of(chart);
  if (spec.equal_scales && chart.x_range && panel.y_range) {
    if (is_constant(x) && !is_constant(y)) chart.x_range = {x.low, x.high};  // along a straight line
    if (is_constant(y) && !is_constant(x)) panel.y_range = {y.low, y.high};
    equalize(*chart.x_range, *panel.y_range, (at.right - at.left) * spec.width, at.plot_height * spec.height);
  }
  std::size_t first = 0;
  while (first + 1 < spec.x.size() && !(std::isfinite(spec.x[first]) && std::isfinite(spec.y[first]))) ++first;
  panel.notes = {{spec.x[first], spec.y[first], "start"}};
  write_chart(path, chart);
}

}  // namespace lockstep
