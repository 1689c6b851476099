// The verb sweep: a scene run many times with other values, one row a run.
#include <lockstep/sweep.h>

#include <spdlog/fmt/fmt.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>

#include <lockstep/analysis.h>
#include "framework/tools/program/commands.h"
#include "framework/tools/program/files.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/sweep/sweep_lanes.h"
#include <lockstep/error.h>
#include "framework/foundation/support/thrown.h"

namespace lockstep {
namespace {

constexpr long kMostTries = 100;  // runs that are built to find the columns
constexpr long kMostReasons = 5;  // failures that are said at once
constexpr long kLanes = 8;        // runs at once
constexpr long kFewest = 3;       // runs for which lanes are worth it

// Bad words of an option, whoever found them.
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

void refuse_twofold(const Words& w, const std::vector<Variable>& variables) {
  const std::pair<const char*, const std::string*> options[] = {
      {"integrator", &w.integrator},      {"solver", &w.solver}, {"step", &w.step},
      {"tolerance", &w.tolerance},        {"until", &w.until},   {"formulation", &w.formulation},
      {"stabilization", &w.stabilization}};
  for (const Variable& v : variables) {
    for (const auto& [name, word] : options) {
      const std::string place = std::string("run.") + name;
      if (!word->empty() && (v.place == place || v.place.rfind(place + ".", 0) == 0))
        throw UsageError(fmt::format("--{}: \"{}\" varies; leave one of the two out", name, v.path));
    }
    if ((!w.planar.empty() || w.full) && v.place == "planar")
      throw UsageError("--planar: \"planar\" varies; leave one of the two out");
  }
}

/// What all runs share.
struct Plan {
  const Words& words;
  Loaded loaded;
  std::vector<Variable> variables;
  Grid grid;
  Shard shard;
  Table columns;

  Scene scene(long run) const {
    Scene s = varied(loaded.scene, variables, grid.at(run), loaded.registry);
    put_over(s.run, words, loaded.registry);
    return s;
  }
  std::string setting(long run) const { return setting_text(variables, grid.at(run)); }
};

// A key that the scene leaves out may not fit beside those that it has.
void refuse_misplaced(const Plan& plan, const std::string& reason) {
  for (const Variable& v : plan.variables)
    if (!v.near.empty())
      throw UsageError(
          fmt::format("--vary: \"{}\" is not in the scene, and no run can be built with it ({}); did you mean \"{}\"?",
                      v.path, reason, v.near));
}

// The columns of the first run that can be built, the same for all shards. When none can, the scene is to blame.
Table columns_of(const Plan& plan) {
  std::optional<SceneError> first;
  const long n = plan.grid.n_runs(), tries = std::min(n, kMostTries);
  for (long k = 0; k < tries; ++k) {
    try {
      return recorded_columns(plan.scene(1 + k * (n - 1) / std::max(tries - 1, 1l)), plan.loaded.registry);
    } catch (const SceneError& error) {
      if (!first) first = error;
    } catch (const ModelError& error) {
      if (!first) first = SceneError(error.what());
    }
  }
  refuse_misplaced(plan, first->what());
  throw *first;
}

Plan make_plan(const Words& w) {
  Loaded loaded = read_with_plugins(w);
  const Shard shard = w.shard.empty() ? Shard{} : usage("--shard", [&] { return read_shard(w.shard); });
  std::vector<Variable> variables =
      usage("--vary", [&] { return read_variables(w.vary, loaded.scene, loaded.registry); });
  refuse_twofold(w, variables);
  std::vector<std::size_t> sizes;
  for (const Variable& v : variables) sizes.push_back(v.values.size());
  Grid grid = usage("--vary", [&] { return Grid(sizes); });
  Plan plan{w, std::move(loaded), std::move(variables), std::move(grid), shard, {}};
  plan.columns = columns_of(plan);
  return plan;
}

std::string table_path(const Words& w, Shard shard) {
  const std::string stem = std::filesystem::path(w.scene).stem().string();
  const std::string share = w.shard.empty() ? "" : fmt::format("_{}of{}", shard.index, shard.count);
  return csv_path(w.record, stem + "_sweep" + share + ".json");
}

void make_folder(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError("folder '" + folder + "' cannot be made: " + error.message() + "; check --histories");
}

/// The table, every row on the disk as soon as it is there.
class Rows {
 public:
  explicit Rows(std::string file) : file_(std::move(file)), out_(file_, std::ios::binary | std::ios::trunc) {}
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
  std::string alone{};  // why no run can be in lanes
};

/// The runs of one shard in their order, eight at a time where the mechanism is suited.
class Sweep {
 public:
  Sweep(const Plan& plan, Rows& rows, const Interrupt& interrupt)
      : plan_(plan),
        n_runs_(plan.grid.n_runs(plan.shard)),
        rows_(rows),
        interrupt_(interrupt),
        progress_(static_cast<double>(n_runs_), plan.words.quiet, Counts::runs) {
    if (plan.words.lanes == "off") tally_.alone = "as asked for";
  }

  Tally go() {
    rows_.put(sweep_header(plan_.variables, plan_.columns));
    while (tally_.done < n_runs_ && !interrupt_.asked())
      if (!together() && !one()) break;
    progress_.finish();
    return tally_;
  }
  long n_runs() const { return n_runs_; }

 private:
  // The next eight in lanes. False when they cannot be: the next one goes alone, and seven more before lanes are tried
  // again.
  bool together() {
    const long n = std::min<long>(kLanes, n_runs_ - tally_.done);
    if (!tally_.alone.empty() || n < kFewest || tally_.done < next_try_) return false;
    next_try_ = tally_.done + n;
    std::vector<Scene> scenes;
    std::vector<Table> histories(static_cast<std::size_t>(n));
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

  // False when it was broken off; then it leaves no row.
  bool one() {
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
    if (!plan_.words.histories.empty() && history.n_columns() > 0) keep(n, history);
    rows_.put(sweep_row(n, plan_.variables, plan_.grid.at(n), plan_.columns, run));
    if (run.failed) say(n, run.status);
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
    write_csv((std::filesystem::path(plan_.words.histories) / fmt::format("{:0{}}.csv", number, width)).string(),
              history);
    ++tally_.histories;
  }

  void say(long number, const std::string& reason) {
    if (++tally_.failed > kMostReasons) return;
    progress_.finish();
    fmt::print(stderr, "lockstep: run {} ({}) failed: {}\n", number, plan_.setting(number), reason);
    if (tally_.failed == kMostReasons) fmt::print(stderr, "lockstep: further failures stand in the table only\n");
  }

  const Plan& plan_;
  const long n_runs_;
  Rows& rows_;
  const Interrupt& interrupt_;
  Progress progress_;
  Tally tally_;
  long next_try_ = 0;  // at lanes
};

void print_heading(const Plan& plan, long n) {
  const Scene& scene = plan.loaded.scene;
  fmt::print("{}\n", scene.title.empty() ? scene.file : scene.title);
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
  if (tally.histories > 0) fmt::print("             {} ({} histories)\n", plan.words.histories, tally.histories);
}

}  // namespace

int sweep_command(const Words& w) {
  const Plan plan = make_plan(w);
  const std::string csv = table_path(w, plan.shard);
  check_writable(csv);
  make_folder(w.histories);
  Rows rows(csv);
  const Interrupt interrupt;
  Sweep sweep(plan, rows, interrupt);
  if (!w.quiet) print_heading(plan, sweep.n_runs());
  const Tally tally = sweep.go();
  if (!w.quiet) print_end(plan, tally, csv);
  if (interrupt.asked()) {
    fmt::print(stderr, "lockstep: interrupted; the rows of {} of {} runs are in {}\n", tally.done, sweep.n_runs(), csv);
    return kExitInterrupted;
  }
  return tally.failed > 0 ? kExitFailure : kExitOk;
}

}  // namespace lockstep
