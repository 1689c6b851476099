// SPDX-License-Identifier: BSD-3-Clause
// The command chart: what accuracy costs on this scene, measured on this machine.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/benchmark_fields.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/precision/work_precision_chart.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/report/page.h"

namespace lockstep {
namespace {

constexpr const char* kLimits[] = {"1e-3", "1e-6", "1e-9"};  // m
constexpr std::size_t kMostRows = 3;                         // integrators that a picture of forms shows

std::vector<CostAtError> costs_below(const WorkPrecision& result, const std::string& limit) {
  return costs_at_error(result, std::stod(limit));
}

// For each value of a dimension the best that it took part in, below each limit: which of them wins.
struct Winner {
  std::string by, value, used;  // the formulation if it is another than that of the scene or of the value
  std::vector<std::string> cost;
};
std::vector<Winner> winners_of(const WorkPrecision& result, Formulation base) {
  std::vector<Winner> all;
  const auto runs_in_base = [&](const std::string& integrator) {
    return std::ranges::any_of(result.runs, [&](const WorkPrecisionRun& run) {
      return run.integrator == integrator && run.formulation == base;
    });
  };
  for (const ChartBy by : {ChartBy::integrator, ChartBy::formulation, ChartBy::stabilization, ChartBy::solver}) {
    const std::vector<std::string> values = values_of(result, by);
    for (const std::string& value : values) {
      if (values.size() < 2) break;
      const auto has = [&](const WorkPrecisionRun& run) {
        if (by == ChartBy::solver && needs_no_solver(run.used)) return false;
        return value_of(run, by) == value || (by == ChartBy::formulation && to_string(run.used) == value);
      };
      const auto first = std::ranges::find_if(result.runs, has);
      const bool other = by == ChartBy::integrator && !runs_in_base(value);
      if (first == result.runs.end() || (other && runs_in_base(integrator_type(value)))) continue;  // merged there
      Winner& winner = all.emplace_back(Winner{to_string(by), value, {}, {}});
      if (other) winner.used = to_string(first->formulation);
      for (const WorkPrecisionRun& run : result.runs)
        if (by == ChartBy::formulation && value_of(run, by) == value && run.used != run.formulation)
          winner.used = to_string(run.used);
      for (const char* limit : kLimits) {
        const std::vector<CostAtError> costs = costs_below(result, limit);
        const auto best = std::ranges::find_if(costs, [&](const CostAtError& c) { return has(*c.run); });
        const bool open = std::ranges::any_of(result.open, has) || std::ranges::any_of(result.falling, has);
        double most = 0;
        for (const WorkPrecisionRun& run : result.runs)
          if (has(run)) most = std::max(most, run.cpu);
        winner.cost.push_back(best != costs.end()
                                  ? (best->upper_bound ? "<= " : "") + fmt::format("{:.2g} s", best->run->cpu)
                              : !open    ? "never"
                              : most > 0 ? fmt::format("> {:.2g} s", most)
                                         : "not tried");
      }
    }
  }
  return all;
}

// The scene's own integrator and those that were cheapest at some error.
std::vector<std::string> shown_integrators(const WorkPrecision& result, const WorkPrecisionRun& base) {
  std::vector<std::string> names{base.integrator};
  const auto add = [&](const std::string& name) {
    if (names.size() < kMostRows && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const char* limit : kLimits)
    if (const auto costs = costs_below(result, limit); !costs.empty()) add(recommended(costs)->run->integrator);
  std::erase_if(names, [&](const std::string& name) {
    return std::none_of(result.runs.begin(), result.runs.end(),
                        [&](const WorkPrecisionRun& run) { return run.integrator == name && run.done(); });
  });
  return names;
}

void draw_all(const std::string& base, const WorkPrecision& result, const SceneBenchmark& benchmark,
              const std::string& caption, std::vector<std::string>& files) {
  const auto write = [&](const std::string& name, GridSpec chart) {
    if (chart.panels.empty()) return;
    if (benchmark.imposed)
      chart.remarks.insert(
          chart.remarks.begin(),
          "the motion is fully prescribed: with stabilisation project nothing is integrated, and errors are round-off");
    if (!caption.empty()) chart.remarks.push_back(caption);
    write_grid(base + name, chart);
    files.insert(files.end(), {base + name + ".png", base + name + ".svg"});
  };
  const std::string title = benchmark.title;
  write("", integrators_chart(result, title, benchmark.base, CostKind::cpu));
  write("_evaluations", integrators_chart(result, title, benchmark.base, CostKind::evaluations));
  for (const ChartBy by : {ChartBy::formulation, ChartBy::stabilization, ChartBy::solver}) {
    if (values_of(result, by).size() < 2) continue;
    WorkPrecisionRun shown = benchmark.base;
    const bool chosen = by == ChartBy::formulation || (by == ChartBy::stabilization && benchmark.options.loops);
    if (needs_no_solver(shown.formulation) && !chosen) shown.formulation = Formulation::omega;  // joint has one of each
    write("_" + to_string(by) + "s", forms_chart(result, title, shown, by, shown_integrators(result, benchmark.base)));
  }
}

struct Cheapest {
  double limit;
  CostAtError cost;
};
std::vector<Cheapest> cheapest_of(const WorkPrecision& result) {
  std::vector<Cheapest> all;
  for (const char* limit : kLimits)
    if (const std::vector<CostAtError> costs = costs_below(result, limit); !costs.empty())
      all.push_back({std::stod(limit), *recommended(costs)});
  return all;
}
constexpr const char* kBest =
    "least CPU time with each (<= T: no coarser run missed the error; > T: no run met it, the longest took T)";
const std::string kRecommended =
    fmt::format("recommended (within {:.0f} % of the cheapest, fewest changes to the scene)", 100 * (kTie - 1));
struct Charted {
  const WorkPrecision& result;
  const SceneBenchmark& benchmark;
  std::string no_pictures;
};
const Fields<Cheapest> kCheapestFields =
    Fields<Cheapest>{{"limit", "m", "error below [m]", &Cheapest::limit, digits_text<3>}}.with(&Cheapest::cost,
                                                                                               kCostFields);
const Fields<Winner> kWinnerFields = [] {
  Fields<Winner> all{{"by", "", "by", &Winner::by,
                      [](const Json& by) { return by == "stabilization" ? "stabilisation" : by.get<std::string>(); }},
                     {"value", "", "value", &Winner::value},
                     {"used", "", "used formulation", &Winner::used}};
  for (std::size_t k = 0; k < std::size(kLimits); ++k)
    all.add({fmt::format("below_{}", kLimits[k]), "", fmt::format("below {} m", kLimits[k]),
             [k](const Winner& w) { return w.cost[k]; }});
  return all;
}();
const Fields<Charted> kChartFields =
    Fields<Charted>{{"cheapest", kRecommended, [](const Charted& c) { return cheapest_of(c.result); }, kCheapestFields},
                    {"best", kBest, [](const Charted& c) { return winners_of(c.result, c.benchmark.base.formulation); },
                     kWinnerFields},
                    {"length", "s", "simulated time", [](const Charted& c) { return c.benchmark.trajectory.length; }},
                    {"imposed", "", "", [](const Charted& c) { return c.benchmark.imposed; }}}
        .with([](const Charted& c) -> const WorkPrecision& { return c.result; }, kMeasurementFields)
        .with({{"remarks", "", "left out", [](const Charted& c) { return c.benchmark.remarks; }},
               {"no_pictures", "", "no pictures", &Charted::no_pictures}});

Result chart_scene(const Arguments& given) {
  const Arguments args = measuring_arguments(given);
  Loaded loaded = load(args);
  const std::string base = base_of(args, "_chart");
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], base + ".csv", loaded.scene);

  const Interrupt interrupt;
  SceneBenchmark benchmark = benchmark_of(loaded, args);
  const std::unique_ptr<WorkPrecision> result = measure(benchmark, args, interrupt);
  if (!result) return kExitInterrupted;

  const std::string no_pictures = result->runs.empty()     ? "no run was measured"
                                  : find_gnuplot().empty() ? "gnuplot is not installed (apt install gnuplot-nox)"
                                                           : "";
  Result out(loaded, kChartFields, Charted{*result, benchmark, no_pictures});
  out.even_if_quiet = true;
  out.write(base + ".csv", runs_text(*result));
  if (no_pictures.empty())
    draw_all(base, *result, benchmark, args.has("--caption") ? args["--caption"] : report::measured_words(), out.files);
  if (!report.empty()) {
    write_runs_report(report, text_of(args, loaded), runs_text(*result), "cpu [s]", "position error [m]", true);
    out.files.push_back(report);
  }
  if (interrupt.asked()) fmt::print(stderr, "note: interrupted; the completed runs are written\n");
  out.code = interrupt.asked() ? kExitInterrupted : kExitOk;
  return out;
}

}  // namespace

Command chart_command() {
  return {
      "chart",
      join({measuring_options(),
            {kFolder,
             {"--caption", "TEXT", "last line of the pictures; default: version, date and machine; '': none"}}}),
      chart_scene,
      R"(Each combination is run from coarse to fine settings; the next run is always the one expected to be cheapest. A
combination ends when its error no longer decreases, when it costs a hundred times more than another for the same error,
or when the time is spent. Errors are the largest differences from a reference solution at 101 times; a second method
confirms that reference. Up to half of the remaining time brings every integrator, in the formulation of the scene, to
an error of a thousandth of the motion. A run is valid if `lockstep run` would not report it as WRONG, and if all finer
runs of its combination stay within twice its error.

Example:
  lockstep chart samples/scenes/four_bar.json --budget 60s --out charts
  lockstep chart samples/scenes/chain_10.json --integrators dopri5,dop853 --formulations omega)",
      {&kChartFields.schema()}};
}

}  // namespace lockstep
