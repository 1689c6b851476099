// SPDX-License-Identifier: BSD-3-Clause
// The maps of an atlas as a picture.
#include "framework/tools/commands/atlas_plan.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

// Whether the numbers lie rather on a logarithmic axis: decades apart, or evenly in the logarithm.
bool is_log(const std::vector<double>& x) {
  if (x.front() <= 0 || x.back() < 3 * x.front()) return false;
  if (x.size() == 2) return true;
  const double middle = x[x.size() / 2];
  return std::abs(std::log(middle / std::sqrt(x.front() * x.back()))) <
         std::abs(std::log(middle / (0.5 * (x.front() + x.back()))));
}

const std::vector<MapSpec::Kind> kOutcomes{{"accurate", "#6fbfae"},        {"inaccurate", "#f2c14e"},
                                           {"wrong (flagged)", "#e08a4f"}, {"wrong (not flagged)", "#8e2a5b"},
                                           {"failed", "#cf5b50"},          {"too slow", "#8c8c8c"},
                                           {"not tried", "#d9d9d9"},       {"no reference", "#c3cbd6"},
                                           {"invalid scene", "#efe6da"}};

bool on_axis(const std::vector<double>& axis, double v) { return v >= axis.front() && v <= axis.back(); }

// Crosses for runs that passed singular configurations without projected stages.
Series passed_marks(const AtlasPanel& panel, const std::vector<double>& x, const std::vector<double>& y) {
  Series marks{"passed", {}, {}, SeriesStyle::crosses};
  for (std::size_t i = 0; i < panel.cells.size(); ++i)
    if (panel.cells[i].passed > 0) marks.x.push_back(x[i / y.size()]), marks.y.push_back(y[i % y.size()]);
  return marks;
}

/// Decades of a number as kinds of a map.
struct Decades {
  std::vector<MapSpec::Kind> kinds;
  double kind_of(double x) const {
    if (!std::isfinite(x)) return static_cast<double>(kinds.size()) - 1;
    return std::clamp(std::floor((std::log10(std::max(x, 1e-300)) + 10) / 2) + 1, 0.0,
                      static_cast<double>(kinds.size()) - 2);
  }
};
Decades decades_of(const std::string& what, const std::string& unit) {
  constexpr const char* kColors[] = {"#1b4f8f", "#2f7fb8", "#58b1a8", "#a8d8a0", "#f2e08a", "#f2a65a", "#8a4b1f"};
  Decades d;
  for (int k = 0; k < 7; ++k)
    d.kinds.push_back({k == 0   ? fmt::format("{} below 1e-10{}", what, unit)
                       : k == 6 ? fmt::format("{} above 1{}", what, unit)
                       : k == 5 ? fmt::format("{} to 1{}", what, unit)
                                : fmt::format("{} to 1e{}{}", what, -10 + 2 * k, unit),
                       kColors[k]});
  d.kinds.push_back({"failed, too slow or without reference", "#b5b5b5"});
  return d;
}

}  // namespace

MapGridSpec atlas_picture(const AtlasPlan& plan, const std::string& reference, const std::string& of) {
  MapGridSpec grid;
  grid.title = plan.loaded.title();
  const std::vector<double> x = axis_numbers(plan.variables[0]), y = axis_numbers(plan.variables[1]);
  const Decades decades = of == "energy" ? decades_of("relative imbalance", "") : decades_of("error", " m");
  bool curves = false, marked = false;
  for (const AtlasPanel& panel : plan.panels) {
    if (!panel.unsuited.empty()) continue;
    MapSpec map;
    map.title = panel.name();
    map.x_label = plan.title(0), map.y_label = plan.title(1);
    map.x = x, map.y = y, map.log_x = is_log(x), map.log_y = is_log(y);
    map.kinds = of == "status" ? kOutcomes : decades.kinds;
    map.cells.resize(x.size() * y.size());
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t j = 0; j < y.size(); ++j) {
        const AtlasCell& c = panel.cells[i * y.size() + j];
        const bool ended = c.outcome < AtlasOutcome::stopped;
        map.cells[j * x.size() + i] = of == "status" ? static_cast<double>(c.outcome)
                                                     : decades.kind_of(!ended           ? HUGE_VAL
                                                                       : of == "energy" ? c.energy
                                                                                        : c.error);
      }
    bool any = false;
    for (std::size_t k = 0; k < panel.limit_x.size(); ++k)
      any = any || (on_axis(x, panel.limit_x[k]) && on_axis(y, panel.limit_y[k]));
    if (any) map.curves = {{"limit", panel.limit_x, panel.limit_y, SeriesStyle::lines}}, curves = true;
    if (Series marks = passed_marks(panel, x, y); !marks.x.empty())
      map.curves.push_back(std::move(marks)), marked = true;
    grid.maps.push_back(std::move(map));
  }
  grid.n_columns = std::min<std::size_t>(3, grid.maps.size());
  grid.width = grid.maps.size() == 1 ? 900 : 1300;
  if (grid.maps.size() == 1) grid.map_height = 520;
  if (curves) grid.curve_label = "largest stable step by linear theory at the start";
  if (marked) grid.mark_label = "singular configurations passed without projected stages";
  if (of == "energy") {
    grid.remarks.emplace_back("Largest imbalance of energy over the run, relative to the energy exchanged.");
    return grid;
  }
  grid.remarks.push_back(fmt::format("Error: largest over the run, against the reference solution ({}).", reference));
  if (of != "error")
    grid.remarks.push_back(
        fmt::format("Accurate: up to {:g} of the largest displacement, energy and constraints within their limits. "
                    "Wrong: beyond {:g}.",
                    plan.limits.works, plan.limits.wrong));
  return grid;
}

}  // namespace lockstep
