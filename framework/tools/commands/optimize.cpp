// SPDX-License-Identifier: BSD-3-Clause
// The command optimize: numbers of a scene for which a formula of its run is least or largest.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lockstep/charts.h>
#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/tools/commands/minimize.h"
#include "framework/tools/commands/run_function.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/terminal.h"

namespace lockstep {
namespace {

constexpr int kRuns = 1000;  // default

/// A condition, "max(T) < 3 N m": the formula of its smaller side less the larger one is its excess.
struct Condition {
  std::string text, left, excess;
};

/// A run: its result, the left sides of the conditions, and by how much each is broken.
struct SearchRun {
  Point x;
  SweepRun run;
  double value = NAN;  // of a run that failed
  std::vector<double> left{}, excess{};
  bool holds = false;
};

struct Optimum {
  std::string text, value_text, status;
  Json values;
  double value;
};
struct Optimized {
  std::string objective, unit;
  Optimum start, best;
  std::vector<std::string> conditions;
  std::string ended;
  long runs, failed;
};

const Fields<Optimized>& optimize_fields() {
  static const Fields<Optimum> kOptimum{{"text", "", "with", &Optimum::text},
                                        {"result", "", "", &Optimum::value_text},
                                        {"values", "", "", &Optimum::values},
                                        {"value", "", "", &Optimum::value},
                                        {"status", "", "", &Optimum::status}};
  const auto words = [](const Json& o) {
    const std::string status = o["status"];
    return fmt::format("{} with {}{}", o["result"].get<std::string>(), o["text"].get<std::string>(),
                       status == "ok" ? "" : " (" + status + ")");
  };
  static const Fields<Optimized> kFields{{"objective", "", "", &Optimized::objective},
                                         {"unit", "", "", &Optimized::unit},
                                         {"start", "start", &Optimized::start, kOptimum, words},
                                         {"best", "best", &Optimized::best, kOptimum, words},
                                         {"conditions", "", "conditions", &Optimized::conditions},
                                         {"ended", "", "ended", &Optimized::ended},
                                         {"runs", "", "runs", &Optimized::runs},
                                         {"failed", "", "failed runs", &Optimized::failed, unless_zero}};
  return kFields;
}

/// The runs of a search, in their order.
class Optimization {
 public:
  Optimization(const Arguments& args, const Interrupt& interrupt)
      : runs_(read_ranges(args), interrupt),
        most_(args["--runs"].empty()
                  ? kRuns
                  : whole_number("--runs", args["--runs"], std::numeric_limits<int>::max(), "is not a number of runs")),
        progress_(most_, args.has("--quiet") || args.has("--json"), Counts::runs) {
    const std::string option = args["--minimize"].empty() ? "--maximize" : "--minimize";
    objective_ = args[option];
    if (objective_.empty())
      throw UsageError("--minimize or --maximize is missing; give one, as in --minimize \"max(T)\"");
    if (option == "--maximize") sign_ = -1;
    runs_.add(option, objective_, objective_);
    for (const std::string& text : args.all("--subject-to")) {
      const Sides s = sides_of("--subject-to", text);
      if (s.sign == "==") throw UsageError("--subject-to: \"" + text + "\" is an equation; compare by < or >");
      const bool below = s.sign[0] == '<';
      runs_.add("--subject-to", text, s.left);
      runs_.add("--subject-to", text + " (excess)",
                fmt::format("({}) - ({})", below ? s.left : s.right, below ? s.right : s.left));
      conditions_.push_back(text);
    }
  }

  /// Throws Error if the start fails.
  std::string search(std::string_view method) {
    Minimization m{.start = {},
                   .n_conditions = conditions_.size(),
                   .method = method,
                   .tolerance = tolerance(),
                   .most = most_,
                   .evaluate = {}};
    Point start;
    for (std::size_t k = 0; k < runs_.n(); ++k) {
      const double low = runs_.low(k), high = runs_.high(k);
      start.push_back(std::clamp(runs_.given(k).value_or(0.5 * (low + high)), low, high));
      m.start.push_back((start[k] - low) / (high - low));
    }
    if (evaluate(start); std::isnan(all_[0].value))
      throw Error(fmt::format("the first run, with {}, failed: {}; give values at which it succeeds by --set",
                              runs_.text(start), all_[0].run.status));
    m.evaluate = [&](std::span<const double> u) {
      Point x;
      for (std::size_t k = 0; k < u.size(); ++k) x.push_back(std::lerp(runs_.low(k), runs_.high(k), u[k]));
      return scaled(evaluate(x));
    };
    try {
      const std::string ended = minimize(m);
      progress_.finish();
      return ended;
    } catch (const InterruptedError&) {
      progress_.finish();
      return "interrupted";
    }
  }

  /// The best run of those in which all conditions hold; of all, if they hold in none.
  const SearchRun& best() const {
    const auto is_worse = [&](const SearchRun& a, const SearchRun& b) {
      if (a.holds != b.holds) return b.holds;
      return std::isnan(a.value) ? !std::isnan(b.value) : sign_ * b.value < sign_ * a.value;
    };
    return *std::max_element(all_.begin(), all_.end(), is_worse);
  }

  Optimized result(const std::string& ended) const {
    Optimized o{objective_, runs_.unit(0), optimum(all_[0]), optimum(best()), {}, ended, static_cast<long>(all_.size()),
                0};
    for (std::size_t k = 0; k < conditions_.size(); ++k)
      o.conditions.push_back(fmt::format("{}: {}{}", conditions_[k], with_unit(best().left[k], runs_.unit(1 + 2 * k)),
                                         best().excess[k] > slack(k) ? ", does not hold" : ""));
    o.failed = std::ranges::count_if(all_, [](const SearchRun& e) { return std::isnan(e.value); });
    return o;
  }

  /// A line for each run: its number, values as --vary writes them, the objective, the best one so far, the status.
  std::string csv() const {
    std::vector<std::vector<std::string>> lines{{"run"}};
    for (std::size_t k = 0; k < runs_.n(); ++k)
      lines[0].push_back(column_title({path(k), runs_.varied().shown[k].unit, {}}));
    lines[0].push_back(title());
    lines[0].emplace_back("status");
    for (const SearchRun& e : all_) {
      std::vector<std::string>& line = lines.emplace_back(1, std::to_string(lines.size()));
      for (std::size_t k = 0; k < e.x.size(); ++k) line.push_back(text::number(runs_.shown(k, e.x[k])));
      line.push_back(std::isnan(e.value) ? "" : text::number(e.value));
      line.push_back(e.run.outcome());
    }
    return csv_of(lines);
  }
  std::string title() const { return column_title({objective_, runs_.unit(0), {}}); }
  std::string path(std::size_t k) const { return runs_.varied().variables[k].path; }

  /// The objective of each run, and the best one so far.
  void draw(const std::string& file) const {
    Series each{.label = "run", .x = {}, .y = {}, .style = SeriesStyle::points},
        least{.label = "best", .x = {}, .y = {}};
    double best = NAN;
    for (const SearchRun& e : all_) {
      if (std::isnan(e.value)) continue;
      if (e.holds && !(sign_ * best <= sign_ * e.value)) best = e.value;
      const double n = static_cast<double>(&e - all_.data() + 1);
      each.x.push_back(n), each.y.push_back(e.value), least.x.push_back(n), least.y.push_back(best);
    }
    write_chart(file, {runs_.varied().loaded.title(), "run", {{title(), {each, least}}}});
  }

  const RunFunction& runs() const { return runs_; }
  bool holds() const { return best().holds; }

 private:
  double tolerance() const { return runs_.varied().loaded.scene.run.tolerance.relative; }
  // By how much a condition may be broken: relative to its excess at the start.
  double slack(std::size_t k) const { return tolerance() * std::abs(scale(all_[0].excess[k])); }
  static double scale(double first) { return first != 0 ? std::abs(first) : 1; }

  const SearchRun& evaluate(const Point& x) {
    if (!all_.empty() && all_.back().x == x) return all_.back();
    SearchRun e{x, runs_.at(x)};
    progress_.at(static_cast<double>(all_.size() + 1));
    const std::vector<ColumnRange>& columns = e.run.columns;
    if (!e.run.failed) {
      e.value = columns[0].last;
      for (std::size_t k = 1; k < columns.size(); k += 2)
        e.left.push_back(columns[k].last), e.excess.push_back(columns[k + 1].last);
    }
    all_.push_back(std::move(e));
    SearchRun& added = all_.back();
    added.holds = !added.run.failed;
    for (std::size_t k = 0; k < added.excess.size(); ++k) added.holds = added.holds && added.excess[k] <= slack(k);
    return added;
  }

  // The objective and the conditions relative to their size at the start; of a run that failed the worst ones so far.
  std::vector<double> scaled(const SearchRun& e) {
    if (e.run.failed) return worst_;
    std::vector<double> values{sign_ * e.value / scale(all_[0].value)};
    for (std::size_t k = 0; k < e.excess.size(); ++k) values.push_back(e.excess[k] / scale(all_[0].excess[k]));
    worst_.resize(values.size(), -HUGE_VAL);
    for (std::size_t k = 0; k < values.size(); ++k) worst_[k] = std::max(worst_[k], values[k]);
    return values;
  }

  Optimum optimum(const SearchRun& e) const {
    return {runs_.text(e.x), fmt::format("{} = {}", objective_, with_unit(e.value, runs_.unit(0))), e.run.outcome(),
            runs_.values(e.x), e.value};
  }

  RunFunction runs_;
  int most_;
  Progress progress_;
  double sign_ = 1;
  std::string objective_;
  std::vector<std::string> conditions_;
  std::vector<SearchRun> all_;
  std::vector<double> worst_;
};

Result optimize(const Arguments& args) {
  const Interrupt interrupt;
  Optimization all(args, interrupt);
  const Loaded& loaded = all.runs().varied().loaded;
  all.runs().check_file();
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], "", loaded.scene);
  const std::string ended = all.search(args["--method"]);
  const Optimized found = all.result(ended);
  Result result(loaded, optimize_fields(), found);
  all.runs().conclude(result, all.best().x, all.best().run);
  if (!args["--record"].empty()) result.write(args["--record"], all.csv());
  if (const std::string& picture = args["--picture"]; !picture.empty()) {
    all.draw(picture);
    result.files.push_back(picture);
  }
  if (!report.empty()) {
    ReportText text = text_of(args, loaded);
    for (const auto& [label, fact] : facts_of(text_of(*result.schema, result.data)))
      text.facts.emplace_back(label, fact);
    write_runs_report(report, text, all.csv(), "run", all.title(), false);
    result.files.push_back(report);
  }
  if (ended == "interrupted")
    result.code = kExitInterrupted;
  else if (!all.holds())
    result.code = kExitFailure;
  return result;
}

}  // namespace

Command optimize_command() {
  return {
      "optimize",
      join({settings_options(),
            {Option{"--vary", "NAME=a:b", "a number that varies, and its range; may be repeated"}.needed().repeated(),
             {"--minimize", "FORMULA", "formula of columns and channels at the end of the run"},
             Option{"--maximize", "FORMULA", "the same, to be largest"}.without("--minimize"),
             Option{"--subject-to", "CONDITION",
                    "condition at the end of the run, such as max(T) < 3 N m; may be repeated"}
                 .repeated(),
             Option{"--method", "NAME",
                    "method of NLopt; default sbplx without conditions, else cobyla; direct looks in "
                    "the whole range"}
                 .among(kMinimizers),
             {"--runs", "N", "runs at most; default 1000"},
             kWrite,
             {"--record", "FILE.csv", "one line per run: values, objective, status"},
             {"--picture", "FILE.svg", "draw the objective of each run, as SVG and PNG"},
             {"--report", "FILE.html", "one HTML file with a plot of all runs"},
             {"--quiet", "", "print errors only"},
             kJson.without("--quiet")}}),
      optimize,
      R"--(NAME and FORMULA are those of `lockstep find`. The search begins with the values of the scene. It finds a minimum near
them, which may not be the least one: begin elsewhere by --set, or look with --method direct first. A run that fails counts
as the worst one so far. Exit code 1: the conditions held in no run.

Example:
  lockstep optimize slider_crank.json --vary crank="80 mm:120 mm" --vary rod="200 mm:400 mm" \
    --minimize "max(T)" --subject-to "max(x) - min(x) > 180 mm" --write best.json)--",
      {&optimize_fields().schema()}};
}

}  // namespace lockstep
