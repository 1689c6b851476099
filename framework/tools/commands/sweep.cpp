// SPDX-License-Identifier: BSD-3-Clause
// The verb sweep: a scene run many times with other values, one row a run.
#include <lockstep/log.h>
#include <lockstep/sweep.h>
#include <lockstep/text.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include "framework/description/scene/write.h"
#include "framework/foundation/support/thrown.h"
#include "framework/tools/commands/run_queue.h"
#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/commands/sweep_rest.h"
#include "framework/tools/commands/threads.h"
#include "framework/tools/commands/tool_verbs.h"
#include "framework/tools/program/document.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/program/words.h"
#include "framework/tools/sweep/sweep_lanes.h"
#include "framework/tools/sweep/watched_run.h"

namespace lockstep {
namespace {

constexpr long kMostReasons = 5;  // failures that are printed
constexpr long kLanes = 8;        // runs at once
constexpr long kFewestLanes = 3;  // fewer runs are faster one by one

// The columns and rows of a table by their names alone.
Table without_units(const Table& table) {
  Table plain;
  for (const Column& c : table.columns()) plain.add_column(c.name);
  plain.reserve(table.n_rows());
  std::vector<double> row(table.n_columns());
  for (std::size_t i = 0; i < table.n_rows(); ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = table.columns()[k].values[i];
    plain.add_row(row);
  }
  return plain;
}

// A run as an object: the values that it has, and what they gave.
nlohmann::ordered_json sweep_json(long number, const std::vector<Variable>& variables,
                                  const std::vector<std::size_t>& choice, const Table& columns, const SweepRun& run) {
  using nlohmann::ordered_json;
  ordered_json j = {{"run", number}, {"status", run.outcome()}, {"values", ordered_json::object()}};
  for (std::size_t k = 0; k < variables.size(); ++k)
    j["values"][variables[k].path] = ordered_json::parse(write_json(variables[k].values[choice[k]]));
  j["findings"] = findings_json(run.findings);
  j["steps"] = run.steps, j["cpu"] = run.cpu, j["columns"] = ordered_json::object();
  if (run.failed) return j;
  j["t"] = run.t;
  j["energy"] = {{"verdict", run.energy}, {"imbalance", json_number(run.imbalance)}};
  j["drift"] = {{"violation", json_number(run.violation)}, {"drifted", run.drifted}};
  for (std::size_t k = 0; k < run.columns.size(); ++k)
    j["columns"][columns.columns()[k + 1].name] = {{"final", json_number(run.columns[k].last)},
                                                   {"min", json_number(run.columns[k].least)},
                                                   {"max", json_number(run.columns[k].most)}};
  return j;
}

std::string table_path(const Arguments& args, Shard shard) {
  const std::string stem = stem_of(args["scene"]);
  const std::string share = args["--shard"].empty() ? "" : fmt::format("_{}of{}", shard.index, shard.count);
  return csv_path(args["--record"], stem + "_sweep" + share + ".json");
}

void make_folder(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError("folder '" + folder + "' cannot be made: " + error.message() + "; check --histories");
}

struct Tally {
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();  // with --json
  long done = 0, failed = 0, wrong = 0, kept = 0, histories = 0, in_lanes = 0;
  std::string alone{};  // why the mechanism does not run in lanes
  std::map<std::string_view, std::pair<Finding, long>>
      found{};  // by code: the first warning, and how many runs have one
};

// Whoever shares out runs has a process for each processor.
int jobs_of(const Arguments& args) { return jobs_of(args, args.has("--shard") ? 1 : available_processors()); }

/// The runs of one shard: computed on several threads, eight at a time on each if the mechanism is suited; their rows
/// are written in order.
class Sweep {
 public:
  Sweep(const SweepPlan& plan, GrowingFile& rows, const Interrupt& interrupt)
      : plan_(plan),
        n_runs_(plan.grid.n_runs(plan.shard)),
        rows_(rows),
        mark_(plan.arguments, plan.loaded, rows),
        kept_(begin_rows()),
        interrupt_(interrupt),
        progress_(static_cast<double>(n_runs_), plan.arguments.has("--quiet"), Counts::runs),
        tally_{
            .done = kept_.n, .failed = kept_.failed, .wrong = kept_.wrong, .kept = kept_.n, .alone = why_alone(plan)},
        queue_(n_runs_, tally_.alone.empty() ? kLanes : 1, kFewestLanes, kept_.n),
        under_way_(static_cast<std::size_t>(std::min<long>(jobs_of(plan.arguments), n_runs_))) {
    if (keeps_motion(plan.arguments)) motions_.emplace(plan.grid.n_runs());
  }

  Tally go() {
    {
      std::vector<std::jthread> threads;
      const Stopper stopper{queue_};  // before the threads are joined
      start_threads(threads, under_way_.size(), [this](std::size_t k) { work(under_way_[k]); });
      while (go_on() && !queue_.all_taken()) {
        if (const std::optional<FinishedRun> run = queue_.take(std::chrono::milliseconds(100))) take(*run);
        progress_.at(n_done());
      }
    }
    progress_.finish();
    while (const std::optional<FinishedRun> run = queue_.take_rest()) take(*run);
    queue_.rethrow();
    return tally_;
  }
  /// All rows are there and have their name.
  void committed() const { mark_.remove(); }
  long n_runs() const { return n_runs_; }
  /// Of the runs, for the report; null without one.
  const report::Histories* motions() const { return motions_ ? &*motions_ : nullptr; }

 private:
  std::string header() const {
    if (!plan_.plain_headers) return sweep_header(plan_.variables, plan_.columns);
    std::vector<Variable> variables = plan_.variables;
    for (Variable& v : variables) v.unit.clear();
    return sweep_header(variables, without_units(plan_.columns));
  }

  // The rows that are there, with --resume; else none.
  KeptRows begin_rows() {
    const std::string header = this->header();
    if (plan_.arguments.has("--resume")) {
      mark_.check();
      SweepRun failed;
      failed.failed = true;
      return keep_rows(rows_, header, [&](long k) {
        if (k >= n_runs_) return std::string("no such run");
        const long n = number(k);
        const std::string row = sweep_row(n, plan_.variables, plan_.grid.at(n), plan_.columns, failed);
        const std::string bare = sweep_row(n, {}, {}, plan_.columns, failed);
        return row.substr(0, row.size() - bare.size() + std::to_string(n).size()) + ",";
      });
    }
    rows_.clear();
    mark_.write();
    rows_.append(header);
    rows_.write();
    return {};
  }

  struct Stopper {
    RunQueue& queue;
    ~Stopper() { queue.stop(); }
  };

  bool go_on() const { return !interrupt_.asked() && !queue_.stopped(); }
  double n_done() const {
    double n = static_cast<double>(queue_.n_finished());
    for (const std::atomic<double>& share : under_way_) n += share;
    return std::min(n, static_cast<double>(n_runs_) - 0.001);
  }

  // What a thread does. `share`: of its runs, for the progress.
  void work(std::atomic<double>& share) {
    try {
      while (go_on()) {
        const std::optional<RunGroup> group = queue_.next();
        if (!group) return;
        if (group->n > 1)
          run_lanes(*group, share);
        else
          run_one(group->first, share);
        share = 0;
      }
    } catch (...) {
      queue_.fail(std::current_exception());
    }
  }

  // A group in lanes; if it cannot be, its runs go back to be computed one by one.
  void run_lanes(RunGroup group, std::atomic<double>& share) {
    std::vector<Scene> scenes;
    try {
      const FindingScope unheard;
      for (long k = 0; k < group.n; ++k) scenes.push_back(plan_.scene(number(group.first + k)));
    } catch (const std::exception&) {
      return queue_.split(group);
    }
    std::vector<Table> histories(scenes.size());
    std::vector<SweepRun> runs = sweep_lanes(scenes, plan_.loaded.registry, plan_.columns,
                                             watch_time(share, scenes.front().run.until, static_cast<double>(group.n)),
                                             keeps_histories() ? &histories : nullptr);
    if (runs.empty()) return queue_.split(group);
    std::vector<FinishedRun> done;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const long k = group.first + static_cast<long>(i);
      const bool kept = keep(runs[i], k, histories[i]);
      done.push_back({k, std::move(runs[i]), true, kept});
    }
    queue_.finish(std::move(done));
  }

  void run_one(long k, std::atomic<double>& share) {
    Table history;
    SweepRun run = compute(number(k), share, history);
    const bool kept = keep(run, k, history);
    std::vector<FinishedRun> done;
    done.push_back({k, std::move(run), false, kept});
    queue_.finish(std::move(done));
  }

  SweepRun compute(long number, std::atomic<double>& share, Table& history) {
    Scene scene;
    try {
      const FindingScope unheard;  // the scene as it is written was read before
      scene = plan_.scene(number);
    } catch (const std::exception& error) {
      SweepRun failed;
      failed.failed = true, failed.status = what_of(error);
      return failed;
    }
    const auto go_on = watch(share, scene.run.until, 1);
    if (!motions_ || !motions_->keeps(number))
      return sweep_run(scene, plan_.loaded.registry, plan_.columns, go_on, keeps_histories() ? &history : nullptr);
    const std::unique_ptr<report::Watcher> seen = motions_->watcher();
    return watched_run(scene, plan_.loaded.registry, plan_.columns, go_on, keeps_histories() ? &history : nullptr,
                       {seen.get(), [&](const Mechanism& m, const Table& table) {
                          if (table.n_rows() > 0) motions_->add(number, table, *seen, m);
                        }});
  }

  void take(const FinishedRun& done) {
    const long n = number(done.k);
    rows_.append(sweep_row(n, plan_.variables, plan_.grid.at(n), plan_.columns, done.run));
    rows_.write();
    if (plan_.arguments.has("--json"))
      tally_.runs.push_back(sweep_json(n, plan_.variables, plan_.grid.at(n), plan_.columns, done.run));
    if (done.in_lanes) ++tally_.in_lanes;
    if (done.kept) ++tally_.histories;
    ++tally_.done;
    if (done.run.failed) report(n, done.run.status);
    if (!done.run.failed && done.run.wrong) ++tally_.wrong;
    std::set<std::string_view> codes;
    for (const Finding& f : done.run.findings)
      if (f.severity() == Severity::warning && codes.insert(f.code()).second)
        ++tally_.found.try_emplace(f.code(), f, 0).first->second.second;
  }

  long number(long k) const { return Grid::run(plan_.shard, k); }
  std::function<bool(double)> watch_time(std::atomic<double>& share, double until, double n) {
    return [this, &share, until, n](double t) {
      share = until > 0 ? n * std::min(t / until, 1.0) : 0.0;
      return go_on();
    };
  }
  std::function<bool(const State&)> watch(std::atomic<double>& share, double until, double n) {
    return [watch = watch_time(share, until, n)](const State& s) { return watch(s.t); };
  }

  bool keeps_histories() const { return !plan_.arguments["--histories"].empty(); }

  // Writes the history of a run, if it was asked for and there is one.
  bool keep(const SweepRun& run, long k, const Table& history) const {
    if (!keeps_histories() || run.broken_off || history.n_columns() == 0) return false;
    const std::size_t width = std::to_string(plan_.grid.n_runs()).size();
    write_csv(
        (std::filesystem::path(plan_.arguments["--histories"]) / fmt::format("{:0{}}.csv", number(k), width)).string(),
        plan_.plain_headers ? without_units(history) : history);
    return true;
  }

  void report(long number, const std::string& reason) {
    if (++tally_.failed > kMostReasons) return;
    progress_.finish();
    tell(fmt::format("lockstep: run {} ({}) failed: {}\n", number, plan_.setting(number), reason));
    if (tally_.failed == kMostReasons) tell("lockstep: further failures stand in the table only\n");
  }

  const SweepPlan& plan_;
  const long n_runs_;
  GrowingFile& rows_;
  const SweepMark mark_;
  const KeptRows kept_;
  const Interrupt& interrupt_;
  Progress progress_;
  Tally tally_;
  RunQueue queue_;
  std::optional<report::Histories> motions_;
  std::vector<std::atomic<double>> under_way_;  // of each thread: runs that it has begun, as far as they have come
};

void print_heading(const SweepPlan& plan, long n, const Words& words) {
  words.say("{}\n", plan.loaded.title());
  const std::string share =
      plan.shard.count > 1 ? fmt::format(" of {}, share {}/{}", plan.grid.n_runs(), plan.shard.index, plan.shard.count)
                           : "";
  words.say("  runs       {}{}\n", n, share);
}

void print_end(const SweepPlan& plan, const Tally& tally, const std::string& csv, const Words& words) {
  words.say("  done       {}, {} failed\n", tally.done, tally.failed);
  if (tally.kept > 0) words.say("             {} of them before, when it was interrupted\n", tally.kept);
  if (tally.wrong > 0)
    words.say("  NOT CONSERVED  or drifted: {} of the runs; see the columns energy and violation\n", tally.wrong);
  if (tally.in_lanes > 0) words.say("             {} of them eight at a time, in vector lanes\n", tally.in_lanes);
  if (tally.in_lanes == 0 && !tally.alone.empty()) words.say("             one by one: {}\n", tally.alone);
  words.say("  files      {} ({} rows)\n", csv == "-" ? "the rows on standard output" : csv, tally.done);
  if (tally.histories > 0)
    words.say("             {} ({} histories)\n", plan.arguments["--histories"], tally.histories);
}

void print_json(const SweepPlan& plan, const Tally& tally, const std::string& csv) {
  const nlohmann::ordered_json j = {{"scene", plan.loaded.scene.file},
                                    {"title", plan.loaded.title()},
                                    {"done", tally.done},
                                    {"failed", tally.failed},
                                    {"file", csv},
                                    {"runs", tally.runs}};
  print_result(j);
}

// Rows survive an error and an interruption: the file that grew stays, and the message names it.
Tally run_and_commit(Sweep& sweep, GrowingFile& rows) {
  bool has_name = false;
  try {
    const Tally tally = sweep.go();
    if (tally.done < sweep.n_runs()) return tally;
    rows.commit();
    has_name = true;
    sweep.committed();
    return tally;
  } catch (const std::exception&) {
    if (!has_name) tell(fmt::format("lockstep: the rows so far are in {}\n", rows.partial()));
    throw;
  }
}

// The first variable of numbers against the first result.
void write_report(const SweepPlan& plan, const Tally& tally, const std::string& csv, const std::string& report,
                  const report::Histories* motions, const Words& words) {
  const Variable& v = plan.variables.front();
  const std::vector<Column>& columns = plan.columns.columns();
  const Column result = columns.size() > 1 ? columns[1] : columns.front();
  ReportText text = text_of(plan.arguments, plan.loaded);
  text.panels = plan.loaded.scene.run.draw;
  for (const ChannelRequest& request : plan.loaded.scene.run.record)
    if (!request.name.empty()) text.channels.emplace_back(request.name, request.channel);
  const std::string left_out = motions == nullptr ? "" : motions->left_out();
  if (!left_out.empty())
    text.facts.emplace_back("", "Of the histories this file keeps " + left_out + "; the folder has all their columns.");
  if (motions != nullptr && tally.kept > 0)
    text.facts.emplace_back(
        "", fmt::format("Of the {} runs before the interruption the page has no curves; the folder has.", tally.kept));
  write_runs_report(report, text, contents_of(csv), column_title({v.path, v.unit, {}}),
                    column_title({result.name + " final", result.unit, {}}), false, motions);
  words.say("             {}{}\n", report, left_out.empty() ? "" : " (of the histories it keeps " + left_out + ")");
  if (motions != nullptr && tally.kept > 0)
    words.say("             without curves of the {} runs before the interruption; {} has them\n", tally.kept,
              plan.arguments["--histories"]);
}

}  // namespace

int sweep_command(const Arguments& args) {
  if (args.has("--quiet")) set_logger(nullptr);
  const Words words(args);
  if (args["--record"] == "-" && !args["--report"].empty())
    throw UsageError("--report: it is made from the rows, which go to standard output; give --record a file");
  const SweepPlan plan = make_sweep_plan(args);
  const std::string csv = table_path(args, plan.shard);
  check_overwrites(csv, plan.loaded.scene);
  make_folder(args["--histories"]);
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], csv, plan.loaded.scene);
  GrowingFile rows(csv);
  const Interrupt interrupt;
  Sweep sweep(plan, rows, interrupt);
  print_heading(plan, sweep.n_runs(), words);
  const Tally tally = run_and_commit(sweep, rows);
  for (const auto& [code, of] : tally.found)
    if (!args.has("--quiet"))
      tell(fmt::format("lockstep: warning: {}{}\n", of.first.text(),
                       of.second > 1 ? fmt::format(" (in {} runs)", of.second) : ""));
  const bool interrupted = tally.done < sweep.n_runs();  // what is there replaces nothing then
  const std::string table = interrupted && csv != "-" ? rows.partial() : csv;
  if (args.has("--json"))
    print_json(plan, tally, table);
  else
    print_end(plan, tally, table, words);
  if (!report.empty())
    write_report(plan, tally, table, interrupted ? unfinished_report(report) : report, sweep.motions(), words);
  if (interrupted) {
    tell(fmt::format("lockstep: interrupted; the rows of {} of {} runs are in {}{}\n", tally.done, sweep.n_runs(),
                     rows.partial(), rows.in_place() ? "" : "; the same command with --resume goes on"));
    return kExitInterrupted;
  }
  return tally.failed > 0 ? kExitFailure : tally.wrong > 0 ? kExitNotConserved : kExitOk;
}

}  // namespace lockstep
