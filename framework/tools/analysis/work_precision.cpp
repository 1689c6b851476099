#include "framework/tools/analysis/work_precision.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include <lockstep/error.h>
#include "framework/tools/analysis/reference.h"

namespace lockstep {
namespace {

constexpr double kFirstDecade = 1.5;  // cost of the second tolerance against the first
constexpr double kFirstTurn = 0.25;   // of its equal share of the time, that a combination gets to show what it takes
constexpr double kFalls = 0.8;   // an error that falls at all falls below this part of the best so far (order 1: half)
constexpr double kWrong = 1e-2;  // of the motion's size
constexpr double kSettled = 1e-7;  // of the motion's size: finer runs that do not fall are at their floor
constexpr long kManySteps = 10;    // steps an output: then outputs cost nothing beside them
constexpr double kPatience =
    4;  // for each place of the form that differs from the base's, and for each turn that was too short
constexpr double kOther = 2;     // for another integrator than the base's
constexpr double kTooDear = 10;  // times the cheapest that met the target

/// One combination on its ladder.
struct Lane {
  const MethodChoice* method;
  const SolverChoice* solver;
  Formulation formulation;
  Stabilization::Kind kind;
  bool adaptive;
  double patience;         // how much dearer another combination's next rung may be and still comes later
  std::size_t rung = 0;    // the next
  double expected = 0;     // s that the next rung takes
  double last_cpu = 0;     // of the rung before
  double best = HUGE_VAL;  // error so far, as a part of the motion's size
  int n_stuck = 0;         // rungs since it fell
  bool met = false;        // the target, by the rung before
  bool over = false;
  std::optional<WorkPrecisionRun> given_up{};  // the next rung, when it took too long for its turn
};

class Survey {
 public:
  Survey(const Trajectory& trajectory, const WorkPrecisionOptions& options)
      : trajectory_(trajectory),
        options_(options),
        clocks_{options.clock ? options.clock : thread_seconds, options.cpu ? options.cpu : thread_seconds},
        begin_(clocks_.clock()) {}

  WorkPrecision run() {
    take_reference();
    plan();
    while (Lane* lane = next()) climb(*lane);
    for (const Lane& lane : lanes_)
      if (lane.given_up) keep(*lane.given_up);
    for (const Lane& lane : lanes_)
      if (!lane.over) result_.left_out.push_back(label(run_of(lane)));
    sort_runs();
    return std::move(result_);
  }

 private:
  void take_reference() {
    Reference r = make_reference(trajectory_, options_, clocks_);
    reference_ = std::move(r.truth), length_ = r.length;
    result_.reference = r.name, result_.second = r.second, result_.agreement = r.agreement;
    result_.size = size_of(reference_, length_);
  }

  // The base, then what differs from it in one place, then the others.
  void plan() {
    const WorkPrecisionOptions& o = options_;
    const auto differs = [](bool a) { return a ? 1 : 0; };
    std::vector<std::pair<int, Lane>> all;
    for (const MethodChoice& method : o.integrators) {
      const std::optional<bool> adaptive = adaptive_of(method);
      if (!adaptive) continue;
      for (const Formulation formulation : o.formulations)
        for (const Stabilization::Kind kind : o.stabilizations)
          for (const SolverChoice& solver : o.solvers) {
            const int in_form = differs(formulation != o.formulations.front()) +
                                differs(kind != o.stabilizations.front()) + differs(&solver != &o.solvers.front());
            const int n = in_form + differs(&method != &o.integrators.front());
            if (o.separately && n > 1) continue;
            const double patience = std::pow(kPatience, in_form) * (n > in_form ? kOther : 1.0);
            all.emplace_back(n, Lane{&method, &solver, formulation, kind, *adaptive, patience});
          }
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [n, lane] : all) lanes_.push_back(lane);
  }

  // Nothing, with the reason said, when the method cannot be made.
  std::optional<bool> adaptive_of(const MethodChoice& method) {
    try {
      return method.make()->info().adaptive;
    } catch (const Error& error) {
      result_.unsuited.push_back({method.name, error.what()});
      return std::nullopt;
    }
  }

  std::size_t n_rungs(const Lane& lane) const {
    return lane.adaptive ? options_.tolerances.size() : options_.steps.size();
  }
  double left() const { return options_.budget - (clocks_.clock() - begin_); }

  // The open combination whose next rung is cheapest and fits; those near the base before the others.
  double weight(const Lane& lane) const {
    const bool begun = lane.rung > 0 || lane.given_up;
    return lane.patience * (begun ? lane.expected : first_);
  }
  Lane* next() {
    const double time = left();
    Lane* best = nullptr;
    for (Lane& lane : lanes_)
      if (!lane.over && lane.expected <= time && (best == nullptr || weight(lane) < weight(*best))) best = &lane;
    return time > 0 ? best : nullptr;
  }

  WorkPrecisionRun run_of(const Lane& lane) const {
    WorkPrecisionRun run;
    run.integrator = lane.method->name, run.solver = lane.solver->name;
    run.formulation = lane.formulation, run.stabilization = lane.kind, run.adaptive = lane.adaptive;
    run.setting = lane.adaptive ? options_.tolerances[lane.rung]
                                : trajectory_.length / trajectory_.outputs / options_.steps[lane.rung];
    return run;
  }

  void climb(Lane& lane) {
    WorkPrecisionRun run = run_of(lane);
    tell(label(run));
    const double share = left() / static_cast<double>(n_open()), begin = clocks_.clock();
    const Outcome last = measure(lane, run, std::min(left(), std::max(4 * lane.expected, kFirstTurn * share)));
    if (last.unsuited) {
      result_.unsuited.push_back({way(run), run.failure});
      lane.over = true;
      return;
    }
    const double spent = clocks_.clock() - begin;
    if (first_ == 0) first_ = spent;
    if (last.given_up) {  // once more when the others have had their turn, with more time
      lane.expected = 2 * spent;
      lane.patience *= kPatience;
      lane.given_up = run;
      return;
    }
    lane.given_up.reset();
    keep(run);
    advance(lane, run, spent);
  }

  void keep(const WorkPrecisionRun& run) {
    result_.runs.push_back(run);
    if (options_.measured) options_.measured(run);
  }

  Outcome measure(const Lane& lane, WorkPrecisionRun& run, double limit) {
    Stabilization stabilization = options_.gains;
    stabilization.kind = lane.kind;
    Recipe recipe{lane.method, lane.solver, {lane.formulation, stabilization}};
    if (lane.adaptive)
      recipe.tolerance = {run.setting, 1e-2 * run.setting}, recipe.step = options_.largest_step;
    else
      recipe.step = run.setting;
    Outcome out = try_run(trajectory_, recipe, limit, clocks_);
    note(out, run, out.cpu);
    if (!run.done()) return out;
    run.error = difference(out.history, reference_, length_);
    if (!std::isfinite(run.error.position)) run.failure = "numbers that are not finite";
    // Outputs between long steps can cost more than the steps: where they change nothing, the time is taken without.
    const bool bare = out.dense && out.report.steps < kManySteps * trajectory_.outputs;
    double cpu = bare ? HUGE_VAL : run.cpu;
    for (int k = bare ? 0 : 1; run.done() && k < std::max(1, options_.repeats); ++k) {
      if (k > 0 && cpu > options_.quick) break;
      const Outcome again = try_run(trajectory_, recipe, limit, clocks_, bare ? TrialKind::bare : TrialKind::looked);
      if (!again.failure.empty()) break;
      cpu = std::min(cpu, again.cpu);
      note(again, run, cpu);
    }
    return out;
  }

  static void note(const Outcome& out, WorkPrecisionRun& run, double cpu) {
    run.cpu = cpu, run.failure = out.failure;
    run.given_up = out.given_up, run.interrupted = out.interrupted;
    run.evaluations = out.work.evaluations, run.factors = out.work.factors;
    run.steps = out.report.steps, run.rejected = out.report.rejected;
  }

  // Whether this combination goes on, and what its next rung will take.
  void advance(Lane& lane, const WorkPrecisionRun& run, double spent) {
    double growth =
        lane.adaptive ? (lane.last_cpu > 0 ? std::clamp(run.cpu / lane.last_cpu, 1.1, 5.0) : kFirstDecade) : 2;
    if (!lane.adaptive && lane.rung + 1 < n_rungs(lane))
      growth = static_cast<double>(options_.steps[lane.rung + 1]) / options_.steps[lane.rung];
    lane.expected = growth * spent;
    lane.last_cpu = run.cpu;
    ++lane.rung;
    lane.over = lane.rung >= n_rungs(lane);
    if (!run.done()) return;
    const double e = relative(run.error);
    lane.n_stuck = e < kFalls * lane.best ? 0 : lane.n_stuck + 1;
    lane.best = std::min(lane.best, e);
    if (lane.n_stuck >= (lane.best < kSettled ? 2 : 4)) lane.over = true;
    if (hopeless(run)) lane.over = true;
    if (options_.target <= 0) return;
    const bool meets = run.error.of(options_.target_kind) <= options_.target;
    if (meets && lane.met) lane.over = true;
    if (meets) cheapest_met_ = std::min(cheapest_met_, run.cpu);
    if (lane.last_cpu > kTooDear * cheapest_met_) lane.over = true;
    lane.met = meets;
  }

  // Largest of the errors, each against the size of what it is an error of; nothing is more right than the reference.
  double relative(const HistoryError& error) const {
    double most = 0;
    for (const ErrorKind kind : kErrorKinds) {
      if (options_.target > 0 && kind != options_.target_kind) continue;
      const double size = result_.size.of(kind);
      if (size > 0) most = std::max(most, std::max(error.of(kind), result_.agreement.of(kind)) / size);
    }
    return most;
  }

  bool hopeless(const WorkPrecisionRun& run) const {
    if (relative(run.error) > kWrong) return false;  // to be as wrong as that is cheap
    return std::any_of(result_.runs.begin(), result_.runs.end(), [&](const WorkPrecisionRun& other) {
      return other.done() && relative(other.error) <= relative(run.error) && run.cpu > options_.hopeless * other.cpu;
    });
  }

  // Combinations one after another in the order of the plan; within each the rungs keep theirs.
  void sort_runs() {
    std::vector<WorkPrecisionRun> sorted;
    for (const Lane& lane : lanes_)
      for (const WorkPrecisionRun& run : result_.runs)
        if (same_way(run_of_first(lane), run)) sorted.push_back(run);
    result_.runs = std::move(sorted);
  }
  WorkPrecisionRun run_of_first(Lane lane) const {
    lane.rung = 0;
    return run_of(lane);
  }

  static std::string way(const WorkPrecisionRun& run) {
    return fmt::format("{}, {}, {}, {}", run.integrator, to_string(run.formulation), to_string(run.stabilization),
                       run.solver);
  }
  std::size_t n_open() const {
    return static_cast<std::size_t>(std::count_if(lanes_.begin(), lanes_.end(), [](const Lane& l) { return !l.over; }));
  }
  void tell(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }

  const Trajectory& trajectory_;
  const WorkPrecisionOptions& options_;
  Clocks clocks_;
  double begin_;
  double length_ = 1, cheapest_met_ = HUGE_VAL;
  double first_ = 0;  // s that the base's first run took: what one that did not begin yet is taken for
  History reference_;
  std::vector<Lane> lanes_;
  WorkPrecision result_;
};

}  // namespace

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double HistoryError::of(ErrorKind kind) const {
  switch (kind) {
    case ErrorKind::position:
      return position;
    case ErrorKind::velocity:
      return velocity;
    case ErrorKind::energy:
      return energy;
    default:
      return reaction;
  }
}

bool same_way(const WorkPrecisionRun& a, const WorkPrecisionRun& b) {
  return a.integrator == b.integrator && a.solver == b.solver && a.formulation == b.formulation &&
         a.stabilization == b.stabilization;
}

WorkPrecision work_precision(const Trajectory& trajectory, const WorkPrecisionOptions& options) {
  if (!(trajectory.length > 0) || trajectory.outputs < 1)
    throw ModelError(
        fmt::format("a chart of {} s with {} outputs has no history; give a length > 0 and an output at least",
                    trajectory.length, trajectory.outputs));
  if (options.integrators.empty() || options.solvers.empty() || options.formulations.empty() ||
      options.stabilizations.empty() || options.references.empty())
    throw ModelError(
        "a chart needs an integrator, a solver, a formulation, a stabilisation and a reference; take them from the "
        "registry");
  if (options.tolerances.empty() || options.steps.empty())
    throw ModelError("a chart needs tolerances and steps; give at least one of each");
  return Survey(trajectory, options).run();
}

}  // namespace lockstep
