// SPDX-License-Identifier: BSD-3-Clause
// The command atlas: maps over any two numbers of a scene in which each method is accurate, inaccurate or fails.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>

#include <lockstep/analysis.h>
#include <lockstep/error.h>
#include <lockstep/log.h>
#include <lockstep/text.h>
#include "framework/foundation/support/thrown.h"
#include "framework/tools/charts/gnuplot.h"
#include "framework/tools/commands/atlas_plan.h"
#include "framework/tools/commands/benchmark.h"
#include "framework/tools/commands/run_queue.h"
#include "framework/tools/commands/tool_commands.h"
#include "framework/tools/program/progress.h"
#include "framework/tools/sweep/step_limit.h"

namespace lockstep {
namespace {

constexpr int kMostTheory = 40;  // bodies up to which small motions are analysed

/// All runs of an atlas, shared out to threads; references first.
class Atlas {
 public:
  Atlas(AtlasPlan& plan, const Interrupt& interrupt, int jobs)
      : plan_(plan), interrupt_(interrupt), jobs_(jobs), n_(plan.grid.n_runs()) {
    long n_panels = 0;
    for (AtlasPanel& panel : plan_.panels) panel.cells.resize(n_), n_panels += panel.unsuited.empty();
    total_ = n_ * n_panels;
    limit_ = std::max(0.1, 5 * plan.budget / static_cast<double>(std::max(1l, total_)));
  }

  void go(Progress& progress) {
    for (long run = 1; run <= n_; ++run) references_[plan_.reference_key(run)].runs.push_back(run);
    std::vector<Shared*> all;
    for (auto& [key, shared] : references_) all.push_back(&shared);
    share_out(static_cast<long>(all.size()), [&](long k) { prepare(*all[k]); });
    // A stride without a common factor: when time is up, what is left out is spread over the maps.
    long stride = std::max(1l, static_cast<long>(0.618 * static_cast<double>(n_)));
    while (std::gcd(stride, n_) != 1) ++stride;
    std::vector<AtlasPanel*> panels;
    for (AtlasPanel& panel : plan_.panels)
      if (panel.unsuited.empty()) panels.push_back(&panel);
    const auto n_panels = static_cast<long>(panels.size());
    std::mutex mutex;
    share_out(total_, [&](long k) {
      std::unique_lock lock(mutex);
      progress.at(static_cast<double>(done_++));
      lock.unlock();
      if (out_of_time()) return;
      compute(*panels[k % n_panels], 1 + (k / n_panels * stride) % n_);
    });
    for (AtlasPanel* panel : panels) add_limit(*panel);
  }

  const AtlasPlan& plan() const { return plan_; }
  long n_runs() const { return n_ * static_cast<long>(plan_.panels.size()); }
  bool any_valid() const {
    return std::ranges::any_of(references_, [](const auto& each) { return !each.second.reference.invalid; });
  }
  bool out_of_time() const { return spent_ > plan_.budget; }
  long n_left() const {  // by the budget
    long n = 0;
    for (const AtlasPanel& panel : plan_.panels)
      for (const AtlasCell& cell : panel.cells)
        n += panel.unsuited.empty() && cell.outcome == AtlasOutcome::untried && cell.reason.empty();
    return out_of_time() ? n : 0;
  }
  double agreement() const {
    double worst = 0;
    for (const auto& [key, shared] : references_) worst = std::max(worst, shared.reference.agreement);
    return worst;
  }
  std::string methods() const {
    std::vector<std::string> names;
    for (const auto& [key, shared] : references_)
      if (!shared.reference.method.empty() && std::ranges::find(names, shared.reference.method) == names.end())
        names.push_back(shared.reference.method);
    return names.empty() ? "none" : text::join(names);
  }
  std::string missing() const {
    for (const auto& [key, shared] : references_)
      if (shared.reference.method.empty()) return shared.reference.reason;
    return {};
  }

 private:
  struct Shared {
    std::vector<long> runs{};
    AtlasReference reference{};
  };

  template <class Work>
  void share_out(long n, Work&& work) {
    std::atomic<long> next = 0;
    std::exception_ptr failed;
    std::mutex mutex;
    const auto loop = [&] {
      const std::exception_ptr thrown = thrown_by([&] {
        for (long k = next++; k < n && !interrupt_.asked(); k = next++) work(k);
      });
      const std::lock_guard lock(mutex);
      if (thrown) failed = thrown, next = n;
    };
    {
      std::vector<std::jthread> threads;
      start_threads(threads, static_cast<std::size_t>(jobs_), [&loop](std::size_t) { loop(); });
    }
    if (failed) std::rethrow_exception(failed);
  }

  void prepare(Shared& shared) {
    std::vector<double> instants;
    std::optional<Scene> scene;
    for (const AtlasPanel& panel : plan_.panels) {
      if (!panel.unsuited.empty()) continue;
      for (const long run : shared.runs) {
        try {
          scene = plan_.scene(run, panel);
        } catch (const Error& error) {
          shared.reference.reason = error.what(), shared.reference.invalid = true;
          continue;
        }
        const std::vector<double> more = atlas_instants(scene->run, panel.adaptive);
        instants.insert(instants.end(), more.begin(), more.end());
      }
    }
    if (!scene) return;
    std::ranges::sort(instants);
    instants.erase(std::unique(instants.begin(), instants.end(), [](double a, double b) { return b - a <= 1e-9 * b; }),
                   instants.end());
    shared.reference = atlas_reference(*scene, plan_.loaded.registry, instants, 0.2 * plan_.budget, go_on_);
  }

  void compute(AtlasPanel& panel, long run) {
    AtlasCell& cell = panel.cells[run - 1];
    const AtlasReference& reference = references_.at(plan_.reference_key(run)).reference;
    if (reference.method.empty()) {
      cell.outcome = reference.invalid ? AtlasOutcome::invalid : AtlasOutcome::no_reference;
      cell.reason = reference.reason;
      return;
    }
    try {
      const Scene scene = plan_.scene(run, panel);
      cell = atlas_run(scene, plan_.loaded.registry, reference, atlas_instants(scene.run, panel.adaptive), plan_.limits,
                       limit_, go_on_);
    } catch (const Error& error) {
      cell.outcome = AtlasOutcome::stopped, cell.reason = error.what(), cell.error = HUGE_VAL;
    }
    const std::lock_guard lock(mutex_);
    spent_ = spent_ + cell.cpu;
  }

  // The limit of linear theory along the axis of steps, for each value of the other.
  void add_limit(AtlasPanel& panel) {
    const auto at = std::ranges::find(plan_.variables, "run.step", &Variable::place);
    if (at == plan_.variables.end() || panel.adaptive || interrupt_.asked()) return;
    const auto k = static_cast<std::size_t>(at - plan_.variables.begin());
    const std::vector<double> steps = axis_numbers(plan_.variables[k]), others = axis_numbers(plan_.variables[1 - k]);
    for (std::size_t i = 0; i < others.size(); ++i) {
      const auto run = static_cast<long>(1 + (k == 0 ? i : i * steps.size()));
      double h = NAN;
      try {
        const Scene scene = plan_.scene(run, panel);
        if (build_mechanism(scene, plan_.loaded.registry).system.n_slots() <= kMostTheory)
          h = step_limit(panel.integrator, small_motions(scene, plan_.loaded.registry), 0.1 * steps.front(),
                         10 * steps.back());
      } catch (const Error&) {  // no theory of a start that cannot be evaluated
      }
      const double along = h > 0.1 * steps.front() && h < 10 * steps.back() ? h : NAN;
      panel.limit_x.push_back(k == 0 ? along : others[i]), panel.limit_y.push_back(k == 0 ? others[i] : along);
    }
  }

  AtlasPlan& plan_;
  const Interrupt& interrupt_;
  const std::function<bool()> go_on_ = [this] { return !interrupt_.asked(); };
  const int jobs_;
  const long n_;
  long total_ = 0;
  double limit_ = 0;
  std::map<std::string, Shared> references_;
  std::mutex mutex_;
  std::atomic<double> spent_ = 0;
  long done_ = 0;
};

const Fields<Atlas> kAtlasFields = Fields<Atlas>{
    {"runs", "", "runs", &Atlas::n_runs},
    {"reference", "", "reference", &Atlas::methods},
    {"agreement", "m", "  accuracy", &Atlas::agreement},
    {"missing", "", "no reference for some values", &Atlas::missing},
    {"out_of_time", "", "", &Atlas::out_of_time},
    {"not_tried", "", "budget used up", &Atlas::n_left, [](const Json& n) {
       return n == 0 ? "" : n.dump() + " runs not tried; increase --budget";
     }}}.with(&Atlas::plan, atlas_fields());

Result draw_atlas(const Arguments& args) {
  const std::string of = args.has("--of") ? args["--of"] : "status";
  AtlasPlan plan = make_atlas_plan(args);
  const std::string base = base_of(args, "_atlas");
  const Interrupt interrupt;
  set_logger(nullptr);
  Atlas atlas(plan, interrupt, jobs_of(args, available_processors()));
  {
    Progress progress(static_cast<double>(atlas.n_runs()), args.has("--quiet") || args.has("--json"), Counts::runs);
    atlas.go(progress);
    progress.finish();
  }
  if (!interrupt.asked() && !atlas.any_valid()) throw ModelError(atlas.missing());
  Result result(plan.loaded, kAtlasFields, atlas);
  result.even_if_quiet = true;
  result.write(base + ".csv", atlas_csv(plan));
  const bool any = std::ranges::any_of(plan.panels, [](const AtlasPanel& p) { return p.unsuited.empty(); });
  if (any && !find_gnuplot().empty()) {
    write_map_grid(base, atlas_picture(plan, atlas.methods(), of));
    result.files.insert(result.files.end(), {base + ".png", base + ".svg"});
  }
  if (interrupt.asked()) {
    fmt::print(stderr, "note: interrupted; the completed runs are written\n");
    result.code = kExitInterrupted;
  } else if (!any) {
    throw UsageError("no method can run this scene: " + plan.panels.front().unsuited);
  }
  return result;
}

}  // namespace

Command atlas_command() {
  return {
      "atlas",
      join({scene_options(),
            {Option{"--vary", "NAME=...", "NAME=a:b:n, NAME=a:b:n:log or NAME=v1,v2,...; twice: x axis, y axis"}
                 .needed()
                 .repeated(),
             Option{"--of", "WHAT", "status (default), error (m), or energy (relative imbalance)"}.among(
                 "status,error,energy"),
             kIntegrators,
             Option{"--stabilizations,--stabilisations", "A,B",
                    "project, baumgarte, none; default: that of the scene, or baumgarte if its gains vary"}
                 .among(kStabilizations),
             Option{"--formulation", "NAME", "coordinates, as in `lockstep run --help`"}.among(kFormulations),
             {"--step", "TIME", "fixed step, or the largest step of an adaptive integrator, s"},
             kUntil,
             {"--error", "ERROR", "error of an accurate run, relative to the largest displacement; default 0.01"},
             kBudget,
             kJobs,
             kFolder,
             kJson,
             {"--quiet", "", "no progress"}}}),
      draw_atlas,
      R"(NAME is any number of the scene, as in `lockstep sweep --help`: run.step, run.tolerance, run.stabilization.alpha,
forces.spring.stiffness, a parameter. NAME=a:b:n are n values evenly, NAME=a:b:n:log evenly in the logarithm. The first
--vary is the x axis. Each method has a map. A run is accurate, inaccurate, wrong, or failed. An accurate run has an error
of at most --error, and `lockstep run` does not report it as WRONG. A wrong run has an error above half of the largest
displacement. Other runs that reach the end are inaccurate. A wrong run is flagged if its energy balance, its
constraint violation, a rotation of more than 1 rad in a step, or a singular configuration passed without projected
stages indicates it. Runs are compared with a reference solution of the same mechanism. Steps are not shortened to meet
output times. A black line is the largest stable step of a method with fixed steps, by linear theory at the start. The
CSV file has a row for every run, with the reason if it failed or was reported as WRONG.

Example:
  lockstep atlas samples/scenes/mass_spring_damper.json --vary run.step=1e-3:3:30:log --vary forces.spring_a.stiffness=1:1e4:20:log --integrators rk4,semi_implicit_euler,radau5)",
      {&kAtlasFields.schema()}};
}

}  // namespace lockstep
