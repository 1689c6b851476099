#include <lockstep/charts.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/tools/charts/chart_style.h"
#include <lockstep/error.h>

namespace lockstep {
namespace {
using namespace chart_style;

Extent extent_x(const ChartSpec& spec) {
  Extent x{};
  for (const Panel& p : spec.panels)
    for (const Series& s : p.series) x.take(s.x, spec.log_x);
  return x;
}

void check(const ChartSpec& spec) {
  if (spec.panels.empty())
    throw ModelError(fmt::format("chart \"{}\" has no panels; give it at least one", spec.title));
  for (const Panel& p : spec.panels) {
    Extent x{}, y{};
    for (const Series& s : p.series) {
      chart_style::check(s, spec.title);
      x.take(s.x, spec.log_x);
      y.take(s.y, p.log_y);
    }
    if (!x.any || !y.any)
      throw ModelError(fmt::format("chart \"{}\": panel \"{}\" has nothing to draw; give it a series with numbers{}",
                                   spec.title, p.y_label,
                                   spec.log_x || p.log_y ? " above zero, or take the logarithm away" : ""));
  }
}

std::string block(std::size_t panel, std::size_t series) { return fmt::format("p{}s{}", panel, series); }

void range(Script& out, char a, const std::optional<Range>& r) {
  if (r)
    out.line(fmt::format("set {}range [{}:{}]", a, r->first, r->second));
  else
    out.line(fmt::format("set {}range [*:*]{}", a, a == 'x' ? " noextend" : ""));
}

// What is there and a twentieth of it above and below; around what stays constant, a twentieth of its size.
// Nothing where that is beyond all numbers.
std::optional<Range> with_margin(const Extent& y) {
  constexpr double kPart = 0.05, kConstant = 1e-5;
  const double size = std::max(std::abs(y.low), std::abs(y.high)), span = y.high - y.low;
  if (size == 0) return Range{-1, 1};
  const double margin = kPart * (span > kConstant * size ? span : size);
  const Range r{y.low - margin, y.high + margin};
  return std::isfinite(r.first) && std::isfinite(r.second) ? std::optional(r) : std::nullopt;
}

constexpr double kLeft = 104, kRight = 28;  // pixels beside the panels

struct Legend {
  std::size_t n_columns, n_rows;
  double width;  ///< letters that a column gets beyond gnuplot's own count, which takes them for narrower than they are
};

Legend legend_of(const Panel& p, int picture_width) {
  constexpr double kLetter = 10, kSample = 70;
  std::size_t n = 0, longest = 0;
  for (const Series& s : p.series) {
    n += s.label.empty() ? 0 : 1;
    longest = std::max(longest, s.label.size());
  }
  const double letters = static_cast<double>(longest), one = kLetter * letters + kSample;
  const auto columns = static_cast<std::size_t>(std::clamp((picture_width - kLeft - kRight) / one, 1.0, 20.0));
  return {columns, (n + columns - 1) / columns, 1 + 0.3 * letters};
}

// Places as parts of the picture, from its left and its lower edge.
struct Layout {
  double left, right, first_top, plot_height, pitch;
};

// Every panel has the same room for its legend, that of the panel which needs most, and so the same height.
Layout layout_of(const ChartSpec& spec) {
  constexpr double kRow = 21, kGap = 12;
  std::size_t n_rows = 0;
  for (const Panel& p : spec.panels) n_rows = std::max(n_rows, legend_of(p, spec.width).n_rows);
  const double top = spec.title.empty() ? 6 : 46;  // one line in large letters or two in small ones
  const double bottom = spec.x_label.empty() ? 36 : 72;
  const double pitch = (spec.height - top - bottom + kGap) / static_cast<double>(spec.panels.size());
  const double legend = std::min(kRow * static_cast<double>(n_rows) + 6, 0.5 * pitch);
  const double plot = std::max(pitch - kGap - legend, 0.3 * pitch);
  return {kLeft / spec.width, 1 - kRight / spec.width, 1 - (top + legend) / spec.height, plot / spec.height,
          pitch / spec.height};
}

void place(Script& out, const Layout& all, const Legend& legend, std::size_t k) {
  const double top = all.first_top - static_cast<double>(k) * all.pitch;
  out.line(fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}", all.left, all.right));
  out.line(fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}", top, top - all.plot_height));
  out.line(fmt::format("set key at screen {:.5f}, screen {:.5f} left bottom horizontal maxcols {} width {}", all.left,
                       top, legend.n_columns, legend.width));
}

// Distance of the tics, 1, 2 or 5 times a power of ten: no closer than this height holds, but two of them in it.
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
  place(out, layout, legend_of(p, spec.width), k);
  const bool last = k + 1 == spec.panels.size();
  Extent y{};
  for (const Series& s : p.series) y.take(s.y, p.log_y);
  const Extent x = extent_x(spec);
  axis(out, 'x', last ? spec.x_label : "", spec.log_x, x.low, x.high);
  axis(out, 'y', p.y_label, p.log_y, y.low, y.high);
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
  std::string clauses;
  for (std::size_t i = 0; i < p.series.size(); ++i)
    clauses += (i == 0 ? "plot " : ", \\\n     ") + plot_clause(block(k, i), p.series[i], i);
  out.line(clauses);
}

}  // namespace

Series curve(const Table& table, const std::string& x, const std::string& y, const std::string& label) {
  return {label.empty() ? title(table.column(y)) : label, table[x], table[y]};
}

void write_chart(const std::string& path, const ChartSpec& spec) {
  check(spec);
  Script out;
  for (std::size_t k = 0; k < spec.panels.size(); ++k)
    for (std::size_t i = 0; i < spec.panels[k].series.size(); ++i)
      series_data(out, block(k, i), spec.panels[k].series[i]);
  common(out);
  begin_page(out, spec.panels.size(), spec.title);
  const Layout layout = layout_of(spec);
  for (std::size_t k = 0; k < spec.panels.size(); ++k) panel(out, spec, layout, k);
  end_page(out);
  draw(out, path, spec.width, spec.height);
}

}  // namespace lockstep
