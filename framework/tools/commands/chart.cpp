// SPDX-License-Identifier: BSD-3-Clause
// The verb chart: what accuracy costs on this scene, measured on this machine.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/benchmark_json.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/precision/work_precision_chart.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/report/machine.h"

namespace lockstep {
namespace {

constexpr double kLimits[] = {1e-3, 1e-6, 1e-9};  // m
constexpr std::size_t kMostRows = 3;              // integrators that a picture of forms shows

void print_cheapest(const WorkPrecision& result) {
  fmt::print("cheapest run with a position error of at most\n");
  for (const double limit : kLimits) {
    const std::vector<CostAtError> costs = costs_at_error(result, limit);
    if (costs.empty())
      fmt::print("  {:.0e} m   none reached it\n", limit);
    else
      fmt::print("  {:.0e} m   {:>12} CPU  {:7} evaluations  {}  (error {:.1e} m)\n", limit,
                 cost_text(costs.front().run->cpu, costs.front().upper_bound), costs.front().run->evaluations,
                 label(*costs.front().run), costs.front().run->error.position);
  }
}

// For each value of a dimension the best that it took part in: which of them wins.
void print_winners(const WorkPrecision& result, ChartBy by) {
  if (values_of(result, by).size() < 2) return;
  fmt::print("{:<26}", "best with each " + to_string(by));
  for (const double limit : kLimits) fmt::print("{:>14}", fmt::format("{:.0e} m", limit));
  fmt::print("\n");
  for (const std::string& value : values_of(result, by)) {
    fmt::print("  {:<24}", value);
    for (const double limit : kLimits) {
      const std::vector<CostAtError> costs = costs_at_error(result, limit);
      const auto best =
          std::find_if(costs.begin(), costs.end(), [&](const CostAtError& c) { return value_of(*c.run, by) == value; });
      const auto has = [&](const WorkPrecisionRun& run) { return value_of(run, by) == value; };
      const bool open = std::ranges::any_of(result.open, has) || std::ranges::any_of(result.falling, has);
      fmt::print("{:>14}", best != costs.end() ? cost_text(best->run->cpu, best->upper_bound)
                           : open              ? "not tried"
                                               : "never");
    }
    fmt::print("\n");
  }
}

void print_failures(const WorkPrecision& result, const SceneBenchmark& benchmark) {
  std::size_t n = 0;
  for (const WorkPrecisionRun& run : result.runs) n += run.done() || run.given_up ? 0 : 1;
  if (n > 0) fmt::print("{} runs failed (crosses in the pictures); the reasons stand in the CSV file\n", n);
  for (const std::string& remark : benchmark.remarks) fmt::print("left out: {}\n", remark);
  for (const std::string& line : unsuited_lines(result)) fmt::print("left out: {}\n", line);
  if (!result.left_out.empty())
    fmt::print(
        "{} combinations were still climbing when the time was up (\"not tried\" is no \"never\"); give more with "
        "--budget\n",
        result.left_out.size());
}

// The scene's own integrator and those that were cheapest at some error.
std::vector<std::string> shown_integrators(const WorkPrecision& result, const WorkPrecisionRun& base) {
  std::vector<std::string> names{base.integrator};
  const auto add = [&](const std::string& name) {
    if (names.size() < kMostRows && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const double limit : kLimits)
    if (const auto costs = costs_at_error(result, limit); !costs.empty()) add(costs.front().run->integrator);
  std::erase_if(names, [&](const std::string& name) {
    return std::none_of(result.runs.begin(), result.runs.end(),
                        [&](const WorkPrecisionRun& run) { return run.integrator == name && run.done(); });
  });
  return names;
}

std::vector<std::string> draw_all(const std::string& base, const WorkPrecision& result, const SceneBenchmark& benchmark,
                                  const std::string& caption) {
  std::vector<std::string> files;
  const auto write = [&](const std::string& name, GridSpec chart) {
    if (chart.panels.empty()) return;
    if (!caption.empty()) chart.remarks.push_back(caption);
    write_grid(base + name, chart);
    files.push_back(base + name + ".png");
  };
  const std::string title = benchmark.title;
  write("", integrators_chart(result, title, benchmark.base, CostKind::cpu));
  write("_evaluations", integrators_chart(result, title, benchmark.base, CostKind::evaluations));
  for (const ChartBy by : {ChartBy::formulation, ChartBy::stabilization, ChartBy::solver})
    if (values_of(result, by).size() > 1)
      write("_" + to_string(by) + "s",
            forms_chart(result, title, benchmark.base, by, shown_integrators(result, benchmark.base)));
  return files;
}

// What was measured, and which method and form is the cheapest at which error.
void print_all(const WorkPrecision& result, const SceneBenchmark& benchmark) {
  fmt::print("{} runs over {:g} s; truth by {} and {}, which agree to {:.1e} m, {:.1e} m/s, {:.1e} J, {:.1e} N\n",
             result.runs.size(), benchmark.trajectory.length, result.reference, result.second,
             result.agreement.position, result.agreement.velocity, result.agreement.energy, result.agreement.reaction);
  if (benchmark.imposed)
    fmt::print(
        "no freedom is left to integrate: laws impose the whole motion, so that projection gives it exactly at any "
        "step;\n"
        "the integrators' pictures compare them without stabilisation\n");
  print_cheapest(result);
  for (const ChartBy by : {ChartBy::integrator, ChartBy::formulation, ChartBy::stabilization, ChartBy::solver})
    print_winners(result, by);
  print_failures(result, benchmark);
}

/// The files of a chart, and why there are no pictures.
struct ChartFiles {
  std::string table;
  std::vector<std::string> pictures{};
  std::string no_pictures{};
};

ChartFiles write_files(const std::string& base, const WorkPrecision& result, const SceneBenchmark& benchmark,
                       const std::string& caption) {
  ChartFiles files{base + ".csv"};
  write_runs(files.table, result);
  if (result.runs.empty())
    files.no_pictures = "no run was measured";
  else if (find_gnuplot().empty())
    files.no_pictures = "gnuplot is not installed (apt install gnuplot-nox)";
  else
    files.pictures = draw_all(base, result, benchmark, caption);
  return files;
}

void print_files(const ChartFiles& files) {
  fmt::print("files: {}\n", files.table);
  if (!files.no_pictures.empty()) fmt::print("       no pictures: {}\n", files.no_pictures);
  for (const std::string& file : files.pictures) fmt::print("       {}, and as .svg\n", file);
}

void print_json(const Loaded& loaded, const WorkPrecision& result, const SceneBenchmark& benchmark,
                const ChartFiles& files) {
  nlohmann::ordered_json j = {{"scene", loaded.scene.file}, {"title", benchmark.title}};
  j.update(json_of(result));
  j["cheapest"] = nlohmann::ordered_json::array();
  for (const double limit : kLimits)
    if (const std::vector<CostAtError> costs = costs_at_error(result, limit); !costs.empty()) {
      nlohmann::ordered_json cheapest = {{"limit", limit}};
      cheapest.update(json_of(costs.front()));
      j["cheapest"].push_back(std::move(cheapest));
    }
  j["files"] = files.pictures;
  j["files"].insert(j["files"].begin(), files.table);
  print_result(j);
}

}  // namespace

int chart_command(const Arguments& args) {
  Loaded loaded = load(args);
  loaded.scene = in_space(std::move(loaded.scene));  // where all formulations compute it
  const std::string csv = csv_path(
      args["--out"].empty() ? "" : (std::filesystem::path(args["--out"]) / stem_of(args["scene"])).string() + ".csv",
      args["scene"]);
  const std::string base = std::filesystem::path(csv).replace_extension().string() + "_chart";
  check_writable(base + ".csv");
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], base + ".csv", loaded.scene);

  const Interrupt interrupt;
  SceneBenchmark benchmark = benchmark_of(loaded, args, interrupt);
  if (!args.has("--json")) fmt::print("{}\n", benchmark.title);
  const std::unique_ptr<WorkPrecision> result = measure(benchmark, args, interrupt);
  if (!result) return kExitInterrupted;

  const ChartFiles files =
      write_files(base, *result, benchmark, args.has("--caption") ? args["--caption"] : report::measured_words());
  if (args.has("--json")) {
    print_json(loaded, *result, benchmark, files);
  } else {
    print_all(*result, benchmark);
    print_files(files);
  }
  if (!report.empty()) {
    write_runs_report(report, text_of(args, loaded), runs_text(*result), "cpu [s]", "position error [m]", true);
    if (!args.has("--json")) fmt::print("       {}\n", report);
  }
  if (interrupt.asked()) fmt::print(stderr, "lockstep: interrupted; the runs up to there are written\n");
  return interrupt.asked() ? kExitInterrupted : kExitOk;
}

}  // namespace lockstep
