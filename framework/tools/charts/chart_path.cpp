// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/charts/chart_path.h"

#include <algorithm>
#include <cmath>

#include "framework/tools/charts/chart_style.h"

namespace lockstep {
namespace {
using namespace chart_style;

constexpr double kLeftOfPath = 104, kRightOfPath = 40, kAbovePath = 16, kBelowPath = 76;  // pixels around the axes

// The range of the data and a twentieth of it on both sides.
Range with_room(const Extent& e) {
  const double span = std::max({e.high - e.low, 1e-5 * std::max(std::abs(e.low), std::abs(e.high)), 1e-300});
  const double middle = 0.5 * (e.low + e.high);
  return {middle - 0.55 * span, middle + 0.55 * span};
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

void write_path(const std::string& path, const PathSpec& spec) {
  const Series curve{"", spec.x, spec.y};
  check_panel({curve}, false, false, spec.title, spec.y_label, "a curve with numbers");
  Extent x{}, y{};
  x.take(spec.x, false), y.take(spec.y, false);
  Range seen_x = with_room(x), seen_y = with_room(y);
  const double top = kAbovePath + title_height(spec.title);
  const double width = spec.width - kLeftOfPath - kRightOfPath, height = spec.height - top - kBelowPath;
  if (spec.equal_scales) equalize(seen_x, seen_y, width, height);
  std::size_t first = 0;
  while (first + 1 < spec.x.size() && !(std::isfinite(spec.x[first]) && std::isfinite(spec.y[first]))) ++first;
  Script out;
  path_data(out, "p0s0", curve);
  begin_page(out, 1, spec.title);
  margins(out, kLeftOfPath / spec.width, 1 - kRightOfPath / spec.width, 1 - top / spec.height, kBelowPath / spec.height);
  out.line("unset key");
  axis(out, 'x', spec.x_label, false, x.low, x.high);
  axis(out, 'y', spec.y_label, false, y.low, y.high);
  ranges(out, seen_x, seen_y);
  notes(out, {{spec.x[first], spec.y[first], "start"}});
  plot(out, {plot_clause("p0s0", curve, 0)});
  draw_page(out, path, spec.width, spec.height);
}

}  // namespace lockstep
