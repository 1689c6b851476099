#include "framework/record/chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "framework/record/chart_style.h"
#include "framework/support/error.h"

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

// Distance of the tics, 1, 2 or 5 times a power of ten, so that a panel of this height is not crowded.
double tic_step(double low, double high, int height) {
  const double most = std::clamp(height / 45, 2, 10);
  const double raw = (high - low) / most;
  if (!(raw > 0) || !std::isfinite(raw)) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= raw) return digit * power;
  return 10.0 * power;
}

void panel(Script& out, const ChartSpec& spec, std::size_t k) {
  const Panel& p = spec.panels[k];
  const bool last = k + 1 == spec.panels.size();
  Extent y{};
  for (const Series& s : p.series) y.take(s.y, p.log_y);
  const Extent x = extent_x(spec);
  axis(out, 'x', last ? spec.x_label : "", spec.log_x, x.low, x.high);
  axis(out, 'y', p.y_label, p.log_y, y.low, y.high);
  if (!last) out.line("set format x ''");
  if (!p.log_y) {
    const Range r = p.y_range.value_or(Range{y.low, y.high});
    const double step = tic_step(r.first, r.second, (spec.height - 120) / static_cast<int>(spec.panels.size()) - 40);
    out.line(step > 0 ? fmt::format("set ytics {}", step) : std::string("set ytics autofreq"));
  }
  range(out, 'x', spec.x_range);
  range(out, 'y', p.y_range);
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
  for (std::size_t k = 0; k < spec.panels.size(); ++k) panel(out, spec, k);
  end_page(out);
  draw(out, path, spec.width, spec.height);
}

}  // namespace lockstep
