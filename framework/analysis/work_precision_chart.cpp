// The results of work_precision as words, lines of a file and pictures.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "framework/analysis/work_precision.h"
#include "framework/support/error.h"

namespace lockstep {
namespace {

using Runs = std::vector<const WorkPrecisionRun*>;

// In the order of their first run.
template <class Key>
auto distinct(const WorkPrecision& result, Key&& key) {
  std::vector<std::decay_t<decltype(key(result.runs.front()))>> all;
  for (const WorkPrecisionRun& run : result.runs)
    if (std::find(all.begin(), all.end(), key(run)) == all.end()) all.push_back(key(run));
  return all;
}

template <class Wanted>
Series series_of(const WorkPrecision& result, const std::string& label, Wanted&& wanted) {
  Series s{label, {}, {}, SeriesStyle::linespoints};
  for (const WorkPrecisionRun& run : result.runs) {
    if (!wanted(run) || !run.done()) continue;
    s.x.push_back(run.cpu);
    s.y.push_back(std::max(run.error.position, 1e-16));  // nothing is zero on a logarithmic axis
  }
  return s;
}

// Marks above the curves, at the time that was lost.
template <class Wanted>
void add_failures(const WorkPrecision& result, Panel& panel, Wanted&& wanted) {
  double top = 0;
  for (const Series& s : panel.series)
    for (const double y : s.y) top = std::max(top, y);
  Series failed{"failed", {}, {}, SeriesStyle::points, "#999999"};
  for (const WorkPrecisionRun& run : result.runs)
    if (wanted(run) && !run.done())
      failed.x.push_back(std::max(run.cpu, 1e-6)), failed.y.push_back(3 * std::max(top, 1e-3));
  if (!failed.x.empty()) panel.series.push_back(failed);
}

void drop_empty(Panel& panel) {
  std::erase_if(panel.series, [](const Series& s) { return s.x.empty(); });
}

// Below this line the two references differ themselves.
void add_floor(const WorkPrecision& result, ChartSpec& chart) {
  double low = HUGE_VAL, high = 0;
  for (const WorkPrecisionRun& run : result.runs)
    if (run.done()) low = std::min(low, run.cpu), high = std::max(high, run.cpu);
  if (!(result.agreement.position > 0) || high == 0) return;
  for (Panel& panel : chart.panels)
    panel.series.push_back({"the two references differ by this",
                            {low, high},
                            {result.agreement.position, result.agreement.position},
                            SeriesStyle::dashes,
                            "#777777"});
}

std::string quoted_cell(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace

std::string to_string(Formulation f) { return f == Formulation::quaternion ? "quaternion" : "omega"; }

std::string to_string(Stabilization::Kind kind) {
  if (kind == Stabilization::Kind::baumgarte) return "baumgarte";
  return kind == Stabilization::Kind::none ? "none" : "project";
}

std::string label(const WorkPrecisionRun& run) {
  return fmt::format("{}, {} {:.3g}{}, {}, {}", run.integrator, run.adaptive ? "tolerance" : "step", run.setting,
                     run.adaptive ? "" : " s", to_string(run.formulation), to_string(run.stabilization));
}

void write_runs(const std::string& file, const WorkPrecision& result) {
  std::ofstream out(file);
  out << "integrator,formulation,stabilization,solver,tolerance,step [s],position error [m],velocity error "
         "[m/s],energy error [J],"
         "cpu [s],evaluations,steps,rejected,failure\n";
  for (const WorkPrecisionRun& r : result.runs) {
    const std::string setting = r.adaptive ? fmt::format("{},", r.setting) : fmt::format(",{}", r.setting);
    const std::string errors =
        r.done() ? fmt::format("{:.6g},{:.6g},{:.6g}", r.error.position, r.error.velocity, r.error.energy) : ",,";
    out << fmt::format("{},{},{},{},{},{},{:.6g},{},{},{},{}\n", r.integrator, to_string(r.formulation),
                       to_string(r.stabilization), r.solver, setting, errors, r.cpu, r.evaluations, r.steps, r.rejected,
                       r.done() ? "" : quoted_cell(r.failure));
  }
  out.flush();
  if (!out) throw FileError("file '" + file + "' cannot be written; check the folder, or name another");
}

ChartSpec work_precision_chart(const WorkPrecision& result, const std::string& title, ChartBy by,
                               Stabilization::Kind kind, const std::vector<std::string>& only) {
  ChartSpec chart{title, "CPU time of the run [s]", {}};
  chart.log_x = true;
  if (result.runs.empty()) throw ModelError("chart \"" + title + "\" has no runs; give it more time (--budget)");
  const std::string y = "largest position error [m]", solver = result.runs.front().solver;
  const Formulation first = result.runs.front().formulation;
  const auto names = distinct(result, [](const WorkPrecisionRun& r) { return r.integrator; });
  if (by == ChartBy::integrator) {
    Panel panel{
        y + ", " + to_string(first) + ", " + (kind == Stabilization::Kind::none ? "no stabilisation" : to_string(kind)),
        {},
        true};
    const auto same = [&](const WorkPrecisionRun& r) {
      return r.formulation == first && r.stabilization == kind && r.solver == solver;
    };
    for (const std::string& name : names)
      panel.series.push_back(
          series_of(result, name, [&](const WorkPrecisionRun& r) { return r.integrator == name && same(r); }));
    drop_empty(panel);
    add_failures(result, panel, same);
    chart.panels.push_back(panel);
  } else {
    for (const std::string& name : names) {
      if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end()) continue;
      Panel panel{name + ": position error [m]", {}, true};
      const auto same = [&](const WorkPrecisionRun& r) { return r.integrator == name && r.solver == solver; };
      for (const Formulation f : distinct(result, [](const WorkPrecisionRun& r) { return r.formulation; }))
        for (const Stabilization::Kind k : distinct(result, [](const WorkPrecisionRun& r) { return r.stabilization; }))
          panel.series.push_back(series_of(result, to_string(f) + ", " + to_string(k), [&](const WorkPrecisionRun& r) {
            return same(r) && r.formulation == f && r.stabilization == k;
          }));
      drop_empty(panel);
      add_failures(result, panel, same);
      chart.panels.push_back(panel);
    }
    chart.height = 150 + 450 * static_cast<int>(chart.panels.size());
  }
  add_floor(result, chart);
  return chart;
}

}  // namespace lockstep
