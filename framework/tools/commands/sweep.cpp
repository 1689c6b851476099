// SPDX-License-Identifier: BSD-3-Clause
// The command sweep: a scene run many times with varied values, one row per run.
#include <lockstep/log.h>
#include <lockstep/sweep.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include "framework/description/scene/json.h"
#include "framework/foundation/support/at_end.h"
#include "framework/foundation/support/lines.h"
#include "framework/tools/commands/run_queue.h"
#include "framework/tools/commands/sweep_plan.h"
#include "framework/tools/commands/sweep_rest.h"
#include "framework/tools/commands/sweep_results.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/findings.h"
#include "framework/tools/program/growing_file.h"
#include "framework/tools/program/method_specs.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/program/run_report.h"
#include "framework/tools/program/terminal.h"
#include "framework/tools/sweep/watched_run.h"

namespace lockstep {
namespace {

constexpr std::size_t kMostReasons = 5;  // of failures, that are printed

/// A run as a result.
struct SweepRow {
  long number;
  SweepRun run;
  Json values = Json::object();                                // by the paths of the variables
  std::vector<std::pair<std::string, ColumnRange>> columns{};  // of a run that did not fail
};

struct Tally {
  std::vector<SweepRow> runs{};  // with --json
  long asked = 0, done = 0, failed = 0, wrong = 0, kept = 0, histories = 0;
  std::string share{};               // "2/8"
  std::vector<std::string> notes{};  // on the report
  // By code, of requirements with its name: the first warning, and how many runs have one.
  std::map<std::pair<std::string_view, std::string>, std::pair<Finding, long>> found{};
  // By the reason without its digits: the first reason, and the runs that failed by it.
  std::map<std::string, std::pair<std::string, std::vector<long>>> reasons{};
};

// Whoever shares out runs has a process for each processor.
int jobs_of(const Arguments& args) { return jobs_of(args, args.has("--shard") ? 1 : available_processors()); }

/// The runs of one shard: computed on several threads; their rows are written in order.
class Sweep {
 public:
  Sweep(const SweepPlan& plan, GrowingFile& rows, const Interrupt& interrupt)
      : plan_(plan),
        n_runs_(plan.grid.n_runs(plan.shard)),
        rows_(rows),
        results_(plan),
        mark_(plan.arguments, plan.loaded, rows),
        kept_(begin_rows()),
        interrupt_(interrupt),
        progress_(static_cast<double>(n_runs_), plan.arguments.has("--quiet"), Counts::runs),
        tally_{.done = kept_.n, .failed = kept_.failed, .wrong = kept_.wrong, .kept = kept_.n},
        queue_(n_runs_, kept_.n),
        under_way_(static_cast<std::size_t>(std::min<long>(jobs_of(plan.arguments), n_runs_))) {
    if (keeps_motion(plan.arguments)) motions_.emplace(plan.grid.n_runs());
  }

  Tally go() {
    {
      std::vector<std::jthread> threads;
      const AtEnd stopped([this] { queue_.stop(); });  // before the threads are joined
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
  /// All rows are complete and have their name.
  void committed() const { mark_.remove(); }
  /// Of each kind the first warning, and how many runs have one; of each reason of failures the runs.
  void tell_findings() const {
    std::size_t n_told = 0;
    for (const auto& [kind, of] : tally_.reasons) {
      tell_error(fmt::format("{} failed{}: {}", plan_.runs_text(of.second),
                             of.second.size() > 1 ? ", the first by" : "", of.first));
      n_told += of.second.size();
    }
    if (n_told < static_cast<std::size_t>(tally_.failed - kept_.failed))
      tell("note: further failures are listed in the table only\n");
    for (const auto& [kind, of] : tally_.found)
      if (!plan_.arguments.has("--quiet"))
        tell(fmt::format("{}: {}: {}{}\n", to_string(of.first.severity()), kind.first, of.first.text(),
                         of.second > 1 ? fmt::format(" (in {} runs)", of.second) : ""));
  }
  long n_runs() const { return n_runs_; }
  /// Lines of text; none if some runs were made before.
  std::string results() const { return kept_.n > 0 ? "" : results_.text(); }
  /// Of the runs, for the report; null without one.
  const report::Histories* motions() const { return motions_ ? &*motions_ : nullptr; }

 private:
  // The rows that are there, with --resume; else none.
  KeptRows begin_rows() {
    std::vector<Variable> variables = plan_.variables;
    for (Variable& v : variables)
      if (plan_.plain_headers) v.unit.clear();
    const std::string header = sweep_header(variables, plan_.columns);
    if (plan_.arguments.has("--resume")) {
      mark_.check();
      return keep_rows(rows_, header, [&](long k) {
        return k < n_runs_ ? row_begin(number(k), variables, plan_.grid.at(number(k))) + "," : "no such run";
      });
    }
    rows_.clear();
    mark_.write();
    rows_.append(header);
    rows_.write();
    return {};
  }

  bool go_on() const { return !interrupt_.asked() && !queue_.stopped(); }
  double n_done() const {
    double n = static_cast<double>(queue_.n_finished());
    for (const std::atomic<double>& share : under_way_) n += share;
    return std::min(n, static_cast<double>(n_runs_) - 0.001);
  }

  // What a thread does. `share`: of its run, for the progress.
  void work(std::atomic<double>& share) {
    try {
      while (go_on()) {
        const std::optional<long> k = queue_.next();
        if (!k) return;
        run_one(*k, share);
        share = 0;
      }
    } catch (...) {
      queue_.stop(std::current_exception());
    }
  }

  void run_one(long k, std::atomic<double>& share) {
    Table history;
    SweepRun run = compute(number(k), share, history);
    const bool kept = keep(run, k, history);
    queue_.finish({k, std::move(run), kept});
  }

  SweepRun compute(long number, std::atomic<double>& share, Table& history) {
    Scene scene;
    try {
      const FindingScope unheard;  // the scene as it is written was read before
      scene = plan_.scene(number);
    } catch (const std::exception& error) {
      SweepRun failed;
      failed.failed = true, failed.status = fact_of(error);
      return failed;
    }
    const auto go_on = [this, &share, until = scene.run.until](const State& s) {
      share = until > 0 ? std::min(s.t / until, 1.0) : 0.0;
      return this->go_on();
    };
    if (!motions_ || !motions_->keeps(number))
      return sweep_run(scene, plan_.loaded.registry, plan_.columns, go_on, keeps_histories() ? &history : nullptr);
    const std::unique_ptr<report::Frames> seen = motions_->watcher();
    return watched_run(scene, plan_.loaded.registry, plan_.columns, go_on, keeps_histories() ? &history : nullptr,
                       {seen.get(), [&](const Mechanism& m, const Table& table) {
                          if (table.n_rows() > 0) motions_->add(number, table, *seen, m);
                        }});
  }

  void take(const FinishedRun& done) {
    const long n = number(done.k);
    rows_.append(sweep_row(n, plan_.variables, plan_.grid.at(n), plan_.columns, done.run));
    rows_.write();
    results_.add(n, done.run);
    if (plan_.arguments.has("--json")) tally_.runs.push_back(row(n, done.run));
    if (done.kept) ++tally_.histories;
    ++tally_.done;
    if (done.run.failed) add_failure(n, done.run.status);
    if (!done.run.failed && done.run.wrong) ++tally_.wrong;
    decltype(tally_.found) of_run;
    for (const Finding& f : done.run.findings)
      if (f.severity() != Severity::note)
        of_run.try_emplace({f.code(), f.thing.starts_with("requirement") ? f.thing : ""}, f, 1);
    for (const auto& [kind, of] : of_run) ++tally_.found.try_emplace(kind, of.first, 0).first->second.second;
  }

  SweepRow row(long n, const SweepRun& run) const {
    SweepRow row{n, run};
    const std::vector<std::size_t> choice = plan_.grid.at(n);
    for (std::size_t k = 0; k < choice.size(); ++k)
      row.values[plan_.variables[k].path] = Json::parse(write_json(plan_.variables[k].values[choice[k]]));
    for (std::size_t k = 0; k < run.columns.size() && !run.failed; ++k)
      row.columns.emplace_back(plan_.columns.columns()[k + 1].name, run.columns[k]);  // after t
    return row;
  }
  long number(long k) const { return Grid::run(plan_.shard, k); }

  bool keeps_histories() const { return !plan_.arguments["--histories"].empty(); }

  // Writes the history of a run, if it was requested and there is one.
  bool keep(const SweepRun& run, long k, const Table& history) const {
    if (!keeps_histories() || run.broken_off || history.n_columns() == 0) return false;
    const std::string name = fmt::format("{:0{}}.csv", number(k), std::to_string(plan_.grid.n_runs()).size());
    write_csv((std::filesystem::path(plan_.arguments["--histories"]) / name).string(), history, !plan_.plain_headers);
    return true;
  }

  void add_failure(long number, const std::string& reason) {
    ++tally_.failed;
    std::string kind = reason;
    std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) != 0; });
    if (tally_.reasons.size() < kMostReasons || tally_.reasons.contains(kind))
      tally_.reasons.try_emplace(kind, reason, std::vector<long>()).first->second.second.push_back(number);
  }

  const SweepPlan& plan_;
  const long n_runs_;
  GrowingFile& rows_;
  SweepResults results_;
  const SweepMark mark_;
  const KeptRows kept_;
  const Interrupt& interrupt_;
  Progress progress_;
  Tally tally_;
  RunQueue queue_;
  std::optional<report::Histories> motions_;
  std::vector<std::atomic<double>> under_way_;  // of each thread: the run that it has begun, as far as it has come
};

const Fields<ColumnRange> kEndsFields{
    {"final", "", "", &ColumnRange::last}, {"min", "", "", &ColumnRange::least}, {"max", "", "", &ColumnRange::most}};
const Fields<SweepRow> kRowEnergyFields{{"verdict", "", "", [](const SweepRow& r) { return r.run.energy; }},
                                        {"imbalance", "", "", [](const SweepRow& r) { return r.run.imbalance; }}};
const Fields<SweepRow> kRowDriftFields{{"violation", "m", "", [](const SweepRow& r) { return r.run.violation; }},
                                       {"drifted", "", "", [](const SweepRow& r) { return r.run.drifted; }}};
std::optional<SweepRow> if_done(const SweepRow& r) { return r.run.failed ? std::nullopt : std::optional(r); }
const Fields<SweepRow> kSweepRowFields{
    {"run", "", "", &SweepRow::number},
    {"status", "", "", [](const SweepRow& r) { return r.run.outcome(); }},
    {"values", "", "", &SweepRow::values},
    {"findings", "", [](const SweepRow& r) { return r.run.findings; }, kFindingFields},
    {"steps", "", "", [](const SweepRow& r) { return r.run.steps; }},
    {"cpu", "s", "", [](const SweepRow& r) { return r.run.cpu; }},
    {"columns", "", &SweepRow::columns, kEndsFields},
    {"t", "s", "", [](const SweepRow& r) { return r.run.failed ? NAN : r.run.t; }, kUnlessEmpty},
    {"energy", "", if_done, kRowEnergyFields, kUnlessEmpty},
    {"drift", "", if_done, kRowDriftFields, kUnlessEmpty}};
const Fields<Tally> kSweepFields{{"asked", "", "", &Tally::asked},
                                 {"share", "", "share", &Tally::share},
                                 {"done", "", "", &Tally::done},
                                 {"failed", "", "", &Tally::failed},
                                 {"wrong", "", "", &Tally::wrong},
                                 {"kept", "", "done before", &Tally::kept, unless_zero},
                                 {"histories", "", "tables kept", &Tally::histories, unless_zero},
                                 {"notes", "", "report", &Tally::notes},
                                 {"runs", "", &Tally::runs, kSweepRowFields}};

// "9 runs, all succeeded".
std::string summary(const Tally& t) {
  std::string text = fmt::format("  {} run{}", t.asked, t.asked == 1 ? "" : "s");
  if (t.done < t.asked) text += fmt::format(", {} done", t.done);
  if (t.failed > 0) text += fmt::format(", {} failed", t.failed);
  if (t.wrong > 0) text += fmt::format(", {} wrong (energy, constraints or requirements)", t.wrong);
  if (t.done == t.asked && t.failed + t.wrong == 0) text += ", all succeeded";
  return text + "\n";
}

// Rows survive an error and an interruption: the file that grew stays, and the message names it.
Tally run_and_commit(Sweep& sweep, GrowingFile& rows) {
  bool has_name = false, told = false;
  try {
    const Tally tally = sweep.go();
    sweep.tell_findings(), told = true;
    if (tally.done < sweep.n_runs()) return tally;
    rows.commit();
    has_name = true;
    sweep.committed();
    return tally;
  } catch (const std::exception&) {
    if (!told) sweep.tell_findings();
    if (!has_name) tell(fmt::format("note: rows saved in {}\n", rows.partial()));
    throw;
  }
}

// The table with its values in the units of --vary.
std::string shown_table(const SweepPlan& plan, const std::string& csv) {
  std::string text = sweep_header(plan.shown, plan.columns);
  const std::vector<std::string> lines = lines_of(csv);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const long n = std::stol(lines[i]);
    const std::vector<std::size_t> choice = plan.grid.at(n);
    text += row_begin(n, plan.shown, choice) + lines[i].substr(row_begin(n, plan.variables, choice).size()) + "\n";
  }
  return text;
}

// The first variable of numbers against the first result.
void write_report(const SweepPlan& plan, const Tally& tally, const std::string& csv, const std::string& report,
                  const report::Histories* motions, std::vector<std::string>& notes) {
  const Variable& v = plan.shown.front();
  const std::vector<Column>& columns = plan.columns.columns();
  const Column result = columns.size() > 1 ? columns[1] : columns.front();
  ReportText text = text_of(plan.arguments, plan.loaded);
  const std::string left_out = motions == nullptr ? "" : motions->left_out();
  if (!left_out.empty())
    text.facts.emplace_back("", "Of the histories, this file has " + left_out + "; the folder has all their columns.");
  if (motions != nullptr && tally.kept > 0)
    text.facts.emplace_back(
        "", fmt::format("The curves of {} runs before the interruption are in the folder only.", tally.kept));
  write_runs_report(report, text, shown_table(plan, contents_of(csv)), column_title({v.path, v.unit, {}}),
                    column_title({result.name + " final", result.unit, {}}), false, motions);
  if (!left_out.empty()) notes.push_back("of the histories, it has " + left_out);
  if (motions != nullptr && tally.kept > 0)
    notes.push_back(fmt::format("the curves of {} runs before the interruption are in {} only", tally.kept,
                                plan.arguments["--histories"]));
}

Result sweep_scene(const Arguments& args) {
  if (args.has("--quiet")) set_logger(nullptr);
  if (args["--record"] == "-" && !args["--report"].empty())
    throw UsageError("--report: the table goes to standard output, and the report needs it; give --record a file");
  const SweepPlan plan = make_sweep_plan(args);
  const std::string share = args["--shard"].empty() ? "" : fmt::format("_{}of{}", plan.shard.index, plan.shard.count);
  const std::string csv = csv_path(args["--record"], stem_of(args["scene"]) + "_sweep" + share + ".json");
  check_overwrites(csv, plan.loaded.scene);
  make_folder(args["--histories"], "check --histories");
  const std::string report = args["--report"].empty() ? "" : report_path(args["--report"], csv, plan.loaded.scene);
  GrowingFile rows(csv);
  const Interrupt interrupt;
  Sweep sweep(plan, rows, interrupt);
  Tally tally = run_and_commit(sweep, rows);
  tally.asked = sweep.n_runs();
  if (plan.shard.count > 1)
    tally.share = fmt::format("{}/{} of {}", plan.shard.index, plan.shard.count, plan.grid.n_runs());
  const bool interrupted = tally.done < sweep.n_runs();  // its results replace nothing then
  const std::string table = interrupted && csv != "-" ? rows.partial() : csv;
  if (!report.empty())
    write_report(plan, tally, table, interrupted ? unfinished_report(report) : report, sweep.motions(), tally.notes);
  Result result(plan.loaded, kSweepFields, tally);
  result.brief = summary(tally) + text_of(*result.schema, result.data) + sweep.results();
  result.files = {table};
  if (!report.empty()) result.files.push_back(interrupted ? unfinished_report(report) : report);
  if (interrupted)
    tell(fmt::format("note: interrupted; the rows of {} of {} runs are in {}{}\n", tally.done, sweep.n_runs(),
                     rows.partial(), rows.in_place() ? "" : "; continue with the same command and --resume"));
  result.code = interrupted        ? kExitInterrupted
                : tally.failed > 0 ? kExitFailure
                : tally.wrong > 0  ? kExitNotConserved
                                   : kExitOk;
  return result;
}

}  // namespace

Command sweep_command() {
  return {
      "sweep",
      join(
          {settings_options(),
           {Option{"--vary", "NAME=...",
                   "NAME=a:b:n (n values from a to b), NAME=a:b:n:log or NAME=v1,v2,...; may be repeated"}
                .needed()
                .repeated(),
            {"--shard", "i/n", "only every n-th run, beginning with run i (from 1); the default of --jobs is then 1"},
            {"--record", "FILE.csv",
             "the CSV file; default: <scene>_sweep.csv or <scene>_sweep_<i>of<n>.csv, in LOCKSTEP_OUTPUT or here; "
             "-: standard output, messages to standard error"},
            {"--report", "FILE.html",
             "one HTML file with a scatter plot of all runs; with --histories, a click on a point shows its curves and "
             "motion"},
            {"--jobs", "N",
             "threads, 1 to 1024; default: the available processors. Plugins that share data among runs need --jobs 1"},
            {"--histories", "DIR", "folder for the table of each run: 01.csv, 02.csv, ..."},
            kHeaders,
            {"--quiet", "", "print errors only"},
            kJson.without("--quiet"),
            Option{"--resume", "", "continue the same sweep after an interruption, after the lines that exist"}.without(
                "--json")}}),
      sweep_scene,
      R"(NAME is a parameter of the scene, or a path into it: bodies.arm.mass, joints.A.drive.law.slope, gravity.1,
run.tolerance. An item of a list has its name, or its number from 0. Units are those of scenes:
bodies.arm.mass=200g:1kg:5. Several --vary give the full grid.
Each run is one line of the table: number, values, final, min and max of each recorded column, energy verdict and
imbalance, largest violation, steps, CPU seconds, status.
If a run fails, its status is the reason, and the exit code is 1. The exit code is 9 if no run failed, but the energy
error or the constraint violation of one is beyond its limit.
Ctrl-C keeps the lines so far. The page sweep.md shows shards on several machines.

Example:
  lockstep sweep pendulum.json --vary bodies.rod.rod.mass=1:5:100 --vary gravity.1=-9.81,-1.62 --record moon.csv)",
      {&kSweepFields.schema()}};
}

}  // namespace lockstep
