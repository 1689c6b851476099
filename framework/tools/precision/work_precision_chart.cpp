// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/work_precision_chart.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <span>

#include <lockstep/error.h>
#include "framework/foundation/math/limits.h"
#include "framework/tools/charts/chart_style.h"

namespace lockstep {
namespace {

constexpr double kLeast = 1e-16;      // drawn instead of zero
constexpr std::size_t kMostLetters = 185;  // of a line

using Wanted = std::function<bool(const WorkPrecisionRun&)>;
using Curves = std::vector<std::pair<std::string, Wanted>>;  // by label

// Equal to the base in all but `by`. A formulation that automatic chose is that of the base, too.
bool like(WorkPrecisionRun run, const WorkPrecisionRun& base, ChartBy by) {
  if (by != ChartBy::formulation && base.formulation == run.used) run.formulation = run.used;
  for (const ChartBy other : {ChartBy::integrator, ChartBy::formulation, ChartBy::stabilization, ChartBy::solver})
    if (other != by && value_of(run, other) != value_of(base, other)) return false;
  return true;
}

double drawn(double error) { return std::max(error, kLeast); }

// It failed, or its error is many times the size of the motion: it is drawn in the strip.
bool useless(const WorkPrecision& result, const WorkPrecisionRun& run, ErrorKind kind) {
  const double size = std::max(result.size.of(kind), result.agreement.of(kind));
  return !run.done() || !(run.error.of(kind) <= 30 * size);
}

// All runs as a line, the valid ones as points, or the others as rings.
Series curve_of(const WorkPrecision& result, const std::string& label, ErrorKind kind, CostKind by,
                const Wanted& wanted, SeriesStyle style = SeriesStyle::lines) {
  Series s{label, {}, {}, style};
  for (const WorkPrecisionRun& run : result.runs)
    if (wanted(run) && !useless(result, run, kind) &&
        (style == SeriesStyle::lines || counts(result, run, kind) == (style == SeriesStyle::points)))
      s.x.push_back(cost(run, by)), s.y.push_back(drawn(run.error.of(kind)));
  return s;
}

// The Pareto front as a staircase.
Series front_of(const WorkPrecision& result, ErrorKind kind, CostKind by) {
  Series s{"Pareto front of valid runs", {}, {}, SeriesStyle::band, "#ddd6c0"};
  for (const WorkPrecisionRun* run : pareto_front(result, kind, by)) {
    if (useless(result, *run, kind)) continue;
    if (!s.x.empty()) s.x.push_back(cost(*run, by)), s.y.push_back(s.y.back());
    s.x.push_back(cost(*run, by)), s.y.push_back(drawn(run->error.of(kind)));
  }
  return s;
}

// A line at the difference of the two references: smaller errors are meaningless.
void add_floor(const WorkPrecision& result, GridPanel& panel, ErrorKind kind) {
  const double floor = result.agreement.of(kind);
  const chart_style::Extent x = chart_style::extent_of(panel.series, &Series::x, true);
  if (!(floor > 0) || !std::isfinite(floor) || !x.any) return;
  panel.series.push_back(
      {"difference of the references", {x.low, x.high}, {floor, floor}, SeriesStyle::dashes, "#888888"});
}

// A shaded strip above all data, with a cross at its cost for each run that failed, and a ring for one off the scale.
void add_failures(const WorkPrecision& result, GridPanel& panel, CostKind by, const Curves& curves, ErrorKind kind) {
  const chart_style::Extent y = chart_style::extent_of(panel.series, &Series::y, true);
  if (!y.any) return;
  const double decade = std::max(1.0, std::log10(y.high / y.low)), from = y.high * std::pow(10.0, 0.05 * decade);
  bool any = false;
  for (const auto& [label, wanted] : curves)
    for (const SeriesStyle style : {SeriesStyle::crosses, SeriesStyle::rings}) {
      Series failed{label, {}, {}, style};
      for (const WorkPrecisionRun& run : result.runs)
        if (wanted(run) && !run.given_up && useless(result, run, kind) && run.done() == (style == SeriesStyle::rings))
          failed.x.push_back(by == CostKind::cpu ? std::max(run.cpu, 1e-6) : std::max(1.0, cost(run, by))),
              failed.y.push_back(from * std::pow(10.0, 0.05 * decade));
      if (failed.x.empty()) continue;
      panel.series.push_back(failed);
      any = true;
    }
  if (any) panel.strip_from = from;
  panel.y_range = {y.low / std::pow(10.0, 0.05 * decade), any ? from * std::pow(10.0, 0.1 * decade) : from};
}

// A ring at the last point of each curve that could continue: its next setting was not tried, which is no failure.
void add_open_ends(const WorkPrecision& result, GridPanel& panel, ErrorKind kind, CostKind by, const Curves& curves) {
  for (const auto& [label, wanted] : curves) {
    if (std::none_of(result.open.begin(), result.open.end(), wanted)) continue;
    const Series curve = curve_of(result, label, kind, by, wanted);
    if (curve.x.empty()) continue;
    panel.open_ends.x.push_back(curve.x.back()), panel.open_ends.y.push_back(curve.y.back());
  }
}

// The base's solver, or if that does not support this value of `by`, as schur does not support quaternions, the default
// of these, or the first that ran.
std::string solver_for(const WorkPrecision& result, WorkPrecisionRun base, ChartBy by, const std::string& value) {
  if (by == ChartBy::solver) return base.solver;
  std::vector<std::string> candidates = values_of(result, ChartBy::solver);
  candidates.insert(candidates.begin(), {base.solver, "sparse"});
  for (const std::string& solver : candidates) {
    const bool ran = std::any_of(result.runs.begin(), result.runs.end(), [&](const WorkPrecisionRun& run) {
      WorkPrecisionRun wanted = base;
      wanted.solver = solver;
      return run.done() && value_of(run, by) == value && like(run, wanted, by);
    });
    if (ran) return solver;
  }
  return base.solver;
}

std::optional<GridPanel> panel_of(const WorkPrecision& result, const std::string& title, ErrorKind kind, CostKind by,
                                  const Curves& curves) {
  GridPanel panel{
      title, by == CostKind::cpu ? "CPU time of the run [s]" : "evaluations of the equations of motion", {}};
  panel.series.push_back(front_of(result, kind, by));
  for (const auto& [label, wanted] : curves)
    for (const SeriesStyle style : {SeriesStyle::lines, SeriesStyle::points})
      panel.series.push_back(curve_of(result, label, kind, by, wanted, style));
  const Wanted any = [&](const auto& run) {
    return std::ranges::any_of(curves, [&](const auto& curve) { return curve.second(run); });
  };
  panel.series.push_back(curve_of(result, "not valid", kind, by, any, SeriesStyle::rings));
  panel.series.back().color = "#a8a8a8";
  if (std::all_of(panel.series.begin() + 1, panel.series.end(), [](const Series& s) { return s.x.empty(); }))
    return std::nullopt;
  const chart_style::Extent y = chart_style::extent_of(panel.series, &Series::y, true);
  // This error is zero or round-off: no joints, no energy.
  if (!(y.high > 2 * kLeast) || !(result.size.of(kind) > kNegligible)) return std::nullopt;
  add_floor(result, panel, kind);
  add_failures(result, panel, by, curves, kind);
  add_open_ends(result, panel, kind, by, curves);
  std::erase_if(panel.series, [](const Series& s) { return s.x.empty(); });
  return panel;
}

// Of each group of curves a panel for each kind of error that is not negligible.
GridSpec chart_of(const WorkPrecision& result, const std::string& title, std::vector<std::string> first_remarks,
                  const std::vector<std::pair<std::string, Curves>>& groups, std::span<const ErrorKind> kinds,
                  CostKind by) {
  if (result.runs.empty()) throw ModelError("chart \"" + title + "\" has no runs; give it more time (--budget)");
  GridSpec chart{title};
  chart.strip_label = "grey: failed or off scale";
  chart.open_label = "finer settings not tried";
  for (const auto& [name, curves] : groups)
    for (const ErrorKind kind : kinds) {
      const std::string what = fmt::format("{} error [{}]", to_string(kind), unit_of(kind));
      if (auto panel = panel_of(result, name.empty() ? what : name + ": " + what, kind, by, curves))
        chart.panels.push_back(*panel);
    }
  chart.remarks = std::move(first_remarks);
  chart.remarks.push_back(fmt::format("reference: {}; difference from {}: {:.1e} m, {:.1e} m/s, {:.1e} J, {:.1e} N",
                                      result.reference, result.second, result.agreement.position,
                                      result.agreement.velocity, result.agreement.energy, result.agreement.reaction));
  return chart;
}

}  // namespace

std::string value_of(const WorkPrecisionRun& run, ChartBy by) {
  const std::string all[] = {run.integrator, to_string(run.formulation), to_string(run.stabilization), run.solver};
  return all[static_cast<std::size_t>(by)];
}

std::vector<std::string> values_of(const WorkPrecision& result, ChartBy by) {
  std::vector<std::string> all;
  for (const WorkPrecisionRun& run : result.runs)
    if (const std::string v = value_of(run, by); std::find(all.begin(), all.end(), v) == all.end()) all.push_back(v);
  return all;
}

GridSpec integrators_chart(const WorkPrecision& result, const std::string& title, const WorkPrecisionRun& base,
                           CostKind by) {
  Curves curves;
  for (const std::string& name : values_of(result, ChartBy::integrator))
    curves.emplace_back(name, [name, base](const WorkPrecisionRun& run) {
      return run.integrator == name && like(run, base, ChartBy::integrator);
    });
  std::vector<std::string> remarks{
      fmt::format("curves: formulation {}, stabilisation {}{}", value_of(base, ChartBy::formulation),
                  value_of(base, ChartBy::stabilization),
                  needs_no_solver(base.formulation) ? "" : ", solver " + base.solver),
      "Pareto front of valid runs:"};
  std::set<std::string> named;
  for (const WorkPrecisionRun* run : pareto_front(result, ErrorKind::position, by)) {
    const std::string way = way_of(*run);
    if (!named.insert(way).second) continue;
    if (named.size() > 1) remarks.back() += ';';
    if (remarks.back().size() + way.size() > kMostLetters) remarks.emplace_back("   ");
    remarks.back() += ' ' + way;
  }
  if (named.empty()) remarks.back() += " none";
  return chart_of(result, title, std::move(remarks), {{"", curves}}, kErrorKinds, by);
}

GridSpec forms_chart(const WorkPrecision& result, const std::string& title, const WorkPrecisionRun& base, ChartBy by,
                     const std::vector<std::string>& integrators) {
  std::vector<std::pair<std::string, Curves>> groups;
  std::string solvers = base.solver;
  for (const std::string& integrator : integrators) {
    WorkPrecisionRun own = base;
    own.integrator = integrator;
    std::string same;  // the formulation that automatic chose
    for (const WorkPrecisionRun& run : result.runs)
      if (run.done() && run.integrator == integrator && run.formulation == Formulation::automatic)
        same = to_string(run.used);
    Curves curves;
    for (const std::string& value : values_of(result, by)) {
      own.solver = base.solver, own.solver = solver_for(result, own, by, value);
      if (by == ChartBy::formulation && value == same && own.solver != base.solver) continue;  // it is in that curve
      const std::string other = own.solver != base.solver ? "; " + value + ": " + own.solver : std::string();
      if (solvers.find(other) == std::string::npos) solvers += other;
      const bool chosen = value == to_string(Formulation::automatic) && !same.empty();
      curves.emplace_back(chosen ? value + " = " + same : value, [value, own, by](const WorkPrecisionRun& run) {
        return value_of(run, by) == value && like(run, own, by);
      });
    }
    groups.emplace_back(integrator, std::move(curves));
  }
  std::string first = "curves:";
  if (by != ChartBy::formulation) first += " formulation " + to_string(base.formulation) + ",";
  if (by != ChartBy::stabilization) first += " stabilisation " + to_string(base.stabilization) + ",";
  first = by == ChartBy::solver ? first.substr(0, first.size() - 1) : first + " solver " + solvers;
  constexpr ErrorKind kKinds[] = {ErrorKind::position, ErrorKind::reaction};
  return chart_of(result, title, {first}, groups, kKinds, CostKind::cpu);
}

}  // namespace lockstep
