// The verb sweep: a scene run many times with other values, one row a run.
#include <lockstep/log.h>
#include <lockstep/sweep.h>

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include "framework/foundation/support/thrown.h"
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/sweep/sweep_lanes.h"

namespace lockstep {
namespace {

constexpr long kMostBuilt = 100;  // runs that are built to find the columns
constexpr long kMostReasons = 5;  // failures that are printed
constexpr long kLanes = 8;        // runs at once
constexpr long kFewestLanes = 3;  // fewer runs are faster one by one

// Errors in the value of an option become usage errors.
template <class F>
auto usage(const std::string& option, F&& read) {
  try {
    return std::forward<F>(read)();
  } catch (const ModelError& error) {
    throw UsageError(option + ": " + error.what());
  } catch (const SceneError& error) {
    throw UsageError(option + ": " + error.what());
  }
}

void refuse_varied_options(const Arguments& args, const std::vector<Variable>& variables) {
  const std::pair<const char*, const std::string*> options[] = {
      {"integrator", &args.integrator},      {"solver", &args.solver}, {"step", &args.step},
      {"tolerance", &args.tolerance},        {"until", &args.until},   {"formulation", &args.formulation},
      {"stabilization", &args.stabilization}};
  for (const Variable& v : variables) {
    for (const auto& [name, word] : options) {
      const std::string place = std::string("run.") + name;
      if (!word->empty() && (v.place == place || v.place.rfind(place + ".", 0) == 0))
        throw UsageError(fmt::format("--{}: \"{}\" varies; leave one of the two out", name, v.path));
    }
    if ((!args.planar.empty() || args.full) && v.place == "planar")
      throw UsageError("--planar: \"planar\" varies; leave one of the two out");
  }
}

/// What all runs share.
struct Plan {
  const Arguments& arguments;
  Loaded loaded;
  std::vector<Variable> variables;
  Grid grid;
  Shard shard;
  Table columns;

  Scene scene(long run) const {
    Scene s = vary_scene(loaded.scene, variables, grid.at(run), loaded.registry);
    override_settings(s.run, arguments, loaded.registry);
    return s;
  }
  std::string setting(long run) const { return setting_text(variables, grid.at(run)); }
};

// Refuses a variable that the scene does not have, if no run can be built with it.
void refuse_misplaced(const Plan& plan, const std::string& reason) {
  for (const Variable& v : plan.variables)
    if (!v.near.empty())
      throw UsageError(
          fmt::format("--vary: \"{}\" is not in the scene, and no run can be built with it ({}); did you mean \"{}\"?",
                      v.path, reason, v.near));
}

// The columns of the first run that can be built, which are the same for all shards.
Table columns_of(const Plan& plan) {
  std::optional<SceneError> first;
  const long n = plan.grid.n_runs(), n_built = std::min(n, kMostBuilt);
  for (long k = 0; k < n_built; ++k) {
    try {
      return recorded_columns(plan.scene(1 + k * (n - 1) / std::max(n_built - 1, 1l)), plan.loaded.registry);
    } catch (const SceneError& error) {
      if (!first) first = error;
    } catch (const ModelError& error) {
      if (!first) first = SceneError(error.what());
    }
  }
  refuse_misplaced(plan, first->what());
  throw *first;
}

Plan make_plan(const Arguments& args) {
  Loaded loaded = read_with_plugins(args);
  const Shard shard = args.shard.empty() ? Shard{} : usage("--shard", [&] { return read_shard(args.shard); });
  std::vector<Variable> variables =
      usage("--vary", [&] { return read_variables(args.vary, loaded.scene, loaded.registry); });
  refuse_varied_options(args, variables);
  std::vector<std::size_t> sizes;
  for (const Variable& v : variables) sizes.push_back(v.values.size());
  Grid grid = usage("--vary", [&] { return Grid(sizes); });
  Plan plan{args, std::move(loaded), std::move(variables), std::move(grid), shard, {}};
  plan.columns = columns_of(plan);
  return plan;
}

std::string table_path(const Arguments& args, Shard shard) {
  const std::string stem = std::filesystem::path(args.scene).stem().string();
  const std::string share = args.shard.empty() ? "" : fmt::format("_{}of{}", shard.index, shard.count);
  return csv_path(args.record, stem + "_sweep" + share + ".json");
}

void make_folder(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError("folder '" + folder + "' cannot be made: " + error.message() + "; check --histories");
}

/// The table of results; every row is flushed.
class ResultFile {
 public:
  explicit ResultFile(std::string file) : file_(std::move(file)), out_(file_, std::ios::binary | std::ios::trunc) {}
  void put(const std::string& line) {
    errno = 0;
    out_ << line << std::flush;
    if (!out_)
      throw FileError(fmt::format("cannot write '{}': {}; check the folder and the space left", file_,
                                  errno != 0 ? std::strerror(errno) : "writing failed"));
  }

 private:
  std::string file_;
  std::ofstream out_;
};

struct Tally {
  long done = 0, failed = 0, histories = 0, in_lanes = 0;
  std::string alone{};  // why the mechanism does not run in lanes
};

/// The runs of one shard in their order, eight at a time if the mechanism is suited.
class Sweep {
 public:
  Sweep(const Plan& plan, ResultFile& rows, const Interrupt& interrupt)
      : plan_(plan),
        n_runs_(plan.grid.n_runs(plan.shard)),
        rows_(rows),
        interrupt_(interrupt),
        progress_(static_cast<double>(n_runs_), plan.arguments.quiet, Counts::runs) {
    if (plan.arguments.lanes == "off") tally_.alone = "as asked for";
  }

  Tally go() {
    rows_.put(sweep_header(plan_.variables, plan_.columns));
    while (tally_.done < n_runs_ && !interrupt_.asked())
      if (!run_lanes() && !run_one()) break;
    progress_.finish();
    return tally_;
  }
  long n_runs() const { return n_runs_; }

 private:
  // The next eight in lanes. False if they cannot be: then they run one by one before lanes are tried again.
  bool run_lanes() {
    const long n = std::min<long>(kLanes, n_runs_ - tally_.done);
    if (!tally_.alone.empty() || n < kFewestLanes || tally_.done < next_try_) return false;
    next_try_ = tally_.done + n;
    std::vector<Scene> scenes;
    std::vector<Table> histories(n);
    try {
      for (long k = 0; k < n; ++k) scenes.push_back(plan_.scene(number(tally_.done + k)));
    } catch (const std::exception&) {
      return false;
    }
    const LaneRuns lanes = sweep_lanes(scenes, plan_.loaded.registry, plan_.columns,
                                       watch(scenes.front().run.until, static_cast<double>(n)), &histories);
    tally_.alone = lanes.unsuited;
    if (lanes.runs.empty() || lanes.runs.front().broken_off) return false;
    for (std::size_t k = 0; k < lanes.runs.size() && !lanes.runs[k].broken_off; ++k) take(lanes.runs[k], histories[k]);
    tally_.in_lanes += n;
    return true;
  }

  // False if it was interrupted; then there is no row.
  bool run_one() {
    Table history;
    const SweepRun run = compute(number(tally_.done), history);
    if (!run.broken_off) take(run, history);
    return !run.broken_off;
  }

  SweepRun compute(long number, Table& history) {
    Scene scene;
    try {
      scene = plan_.scene(number);
    } catch (const std::exception& error) {
      SweepRun failed;
      failed.failed = true, failed.status = what_of(error);
      return failed;
    }
    return sweep_run(scene, plan_.loaded.registry, plan_.columns, watch(scene.run.until, 1), &history);
  }

  void take(const SweepRun& run, const Table& history) {
    const long n = number(tally_.done);
    if (!plan_.arguments.histories.empty() && history.n_columns() > 0) keep(n, history);
    rows_.put(sweep_row(n, plan_.variables, plan_.grid.at(n), plan_.columns, run));
    if (run.failed) report(n, run.status);
    progress_.at(static_cast<double>(++tally_.done));
  }

  long number(long k) const { return Grid::run(plan_.shard, k); }
  std::function<bool(const State&)> watch(double until, double n) {
    return [this, until, n](const State& s) {
      progress_.at(static_cast<double>(tally_.done) + std::min(n * s.t / until, n - 0.001));
      return !interrupt_.asked();
    };
  }

  void keep(long number, const Table& history) {
    const std::size_t width = std::to_string(plan_.grid.n_runs()).size();
    write_csv((std::filesystem::path(plan_.arguments.histories) / fmt::format("{:0{}}.csv", number, width)).string(),
              history);
    ++tally_.histories;
  }

  void report(long number, const std::string& reason) {
    if (++tally_.failed > kMostReasons) return;
    progress_.finish();
    fmt::print(stderr, "lockstep: run {} ({}) failed: {}\n", number, plan_.setting(number), reason);
    if (tally_.failed == kMostReasons) fmt::print(stderr, "lockstep: further failures stand in the table only\n");
  }

  const Plan& plan_;
  const long n_runs_;
  ResultFile& rows_;
  const Interrupt& interrupt_;
  Progress progress_;
  Tally tally_;
  long next_try_ = 0;  // number of the run at which lanes are tried again
};

void print_heading(const Plan& plan, long n) {
  fmt::print("{}\n", plan.loaded.title());
  const std::string share =
      plan.shard.count > 1 ? fmt::format(" of {}, share {}/{}", plan.grid.n_runs(), plan.shard.index, plan.shard.count)
                           : "";
  fmt::print("  runs       {}{}\n", n, share);
  std::fflush(stdout);
}

void print_end(const Plan& plan, const Tally& tally, const std::string& csv) {
  fmt::print("  done       {}, {} failed\n", tally.done, tally.failed);
  if (tally.in_lanes > 0) fmt::print("             {} of them eight at a time, in vector lanes\n", tally.in_lanes);
  if (tally.in_lanes == 0 && !tally.alone.empty()) fmt::print("             one by one: {}\n", tally.alone);
  fmt::print("  files      {} ({} rows)\n", csv, tally.done);
  if (tally.histories > 0) fmt::print("             {} ({} histories)\n", plan.arguments.histories, tally.histories);
}

}  // namespace

int sweep_command(const Arguments& args) {
  if (args.quiet) set_logger(nullptr);
  const Plan plan = make_plan(args);
  const std::string csv = table_path(args, plan.shard);
  check_overwrites(csv, plan.loaded.scene);
  check_writable(csv);
  make_folder(args.histories);
  ResultFile rows(csv);
  const Interrupt interrupt;
  Sweep sweep(plan, rows, interrupt);
  if (!args.quiet) print_heading(plan, sweep.n_runs());
  const Tally tally = sweep.go();
  if (!args.quiet) print_end(plan, tally, csv);
  if (interrupt.asked()) {
    fmt::print(stderr, "lockstep: interrupted; the rows of {} of {} runs are in {}\n", tally.done, sweep.n_runs(), csv);
    return kExitInterrupted;
  }
  return tally.failed > 0 ? kExitFailure : kExitOk;
}

}  // namespace lockstep
