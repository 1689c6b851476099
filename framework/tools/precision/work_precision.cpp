// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/precision/work_precision.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include <lockstep/error.h>
#include "framework/tools/precision/reference.h"

namespace lockstep {
namespace {

constexpr double kFirstGrowth = 1.5;  // assumed cost of the second tolerance relative to the first
constexpr double kFirstTurn = 0.25;   // part of its equal share of the time that a combination gets at first
constexpr double kFalls = 0.8;      // an error that falls at all is below this part of the best so far (order 1: half)
constexpr double kWrong = 1e-2;     // relative error of a useless run
constexpr double kSettled = 1e-7;   // relative error below which a combination that stops falling is at its floor
constexpr long kManySteps = 10;     // steps per output, from which on the cost of outputs is negligible
constexpr double kFirstHits = 0.5;  // part of the budget that the first hits of all integrators may take
constexpr double kPatience = 4;     // handicap of each item of the form that differs from the base's, and of a time-out
constexpr double kOther = 2;        // handicap of another integrator than the base's
constexpr double kTooDear = 10;     // times the cheapest run that met the target, in the base's form; 1 in others

/// One combination, on its way from coarse to fine settings.
struct Combination {
  const MethodChoice* method;
  const SolverChoice* solver;
  WorkPrecisionRun way;    // a run without setting and results
  bool base_form;          // only the integrator differs from the base
  double handicap;         // factor on the expected cost when the next run is chosen
  std::size_t rung = 0;    // the next setting
  double expected = 0;     // s that it will take
  double last_cpu = 0;     // of the setting before
  double best = HUGE_VAL;  // smallest relative error so far
  int n_stuck = 0;         // settings since it fell
  bool met = false;        // the setting before met the target
  bool over = false;
  std::optional<WorkPrecisionRun> given_up{};  // the next setting, if it took too long for its turn
};

class Benchmark {
 public:
  Benchmark(const Trajectory& trajectory, const WorkPrecisionOptions& options)
      : trajectory_(trajectory),
        options_(options),
        clocks_{options.clock ? options.clock : thread_seconds, options.cpu ? options.cpu : thread_seconds},
        begin_(clocks_.clock()) {}

  WorkPrecision run() {
    Reference r = make_reference(trajectory_, options_, clocks_);
    reference_ = std::move(r.truth), length_ = r.length;
    result_.reference = r.name, result_.second = r.second, result_.agreement = r.agreement;
    result_.size = size_of(reference_, length_);
    plan();
    first_end_ = options_.target > 0 ? 0 : left() * (1 - kFirstHits);
    while (Combination* c = next()) climb(*c);
    for (const Combination& c : combinations_)
      if (c.given_up) keep(*c.given_up);
    for (const Combination& c : combinations_)
      if (!c.over) result_.left_out.push_back(label(run_of(c))), result_.open.push_back(run_of(c));
    for (const Combination& c : combinations_)
      if (c.over && c.n_stuck == 0 && any_done(c)) result_.falling.push_back(c.way);
    // By combination in the order of the plan, each from coarse to fine.
    std::vector<WorkPrecisionRun> sorted;
    for (const Combination& c : combinations_)
      for (const WorkPrecisionRun& run : result_.runs)
        if (same_way(run, c.way)) sorted.push_back(run);
    result_.runs = std::move(sorted);
    return std::move(result_);
  }

 private:
  // The base, then what differs from it in one place, then the others.
  void plan() {
    const WorkPrecisionOptions& o = options_;
    const auto differs = [](bool a) { return a ? 1 : 0; };
    std::vector<std::pair<int, Combination>> all;
    for (const MethodChoice& method : o.integrators) {
      const std::optional<bool> adaptive = adaptive_of(method);
      if (!adaptive) continue;
      for (const Formulation formulation : o.formulations)
        for (const Stabilization::Kind kind : o.stabilizations)
          for (const SolverChoice& solver : o.solvers) {
            if (needs_no_solver(formulation)) {  // without constraints the solver makes no difference
              if (&solver != &o.solvers.front()) continue;
              if (!o.loops && kind != o.stabilizations.front()) continue;
            }
            const int in_form = differs(formulation != o.formulations.front()) +
                                differs(kind != o.stabilizations.front()) + differs(&solver != &o.solvers.front());
            const int n = in_form + differs(&method != &o.integrators.front());
            if (o.separately && n > 1) continue;
            const double handicap = std::pow(kPatience, in_form) * (n > in_form ? kOther : 1.0);
            const bool keyed = n > in_form && integrator_type(method.name) != method.name;  // a key is a change as well
            const WorkPrecisionRun way{method.name, solver.name, formulation, kind, *adaptive};
            all.emplace_back(n + differs(keyed), Combination{&method, &solver, way, in_form == 0, handicap});
          }
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto& [n, c] : all) combinations_.push_back(c);
  }

  // None if the method cannot be made; the reason is kept.
  std::optional<bool> adaptive_of(const MethodChoice& method) {
    try {
      return method.make()->info().adaptive;
    } catch (const Error& error) {
      leave_out(method.name, error.what());
      return std::nullopt;
    }
  }

  void leave_out(const std::string& what, const std::string& why) {
    const auto known = std::ranges::find(result_.unsuited, why, &WorkPrecision::Unsuited::why);
    if (known == result_.unsuited.end())
      result_.unsuited.push_back({what, why});
    else
      ++known->n;
  }

  std::size_t n_rungs(const Combination& c) const {
    return c.way.adaptive ? options_.tolerances.size() : options_.steps.size();
  }
  double left() const { return options_.budget - (clocks_.clock() - begin_); }

  // The open combination whose next run is cheapest and fits; those near the base come first.
  double weight(const Combination& c) const { return c.handicap * (c.rung > 0 || c.given_up ? c.expected : first_); }
  // Whether an integrator has not yet had its first hit in the base's form, and there is time for that.
  bool seeks_first_hit(const Combination& c) const {
    const bool sought = options_.target > 0 || !(c.best <= options_.first_hit);
    return sought && c.base_form && !c.over && left() > first_end_;
  }
  Combination* next() {
    const double time = left();
    const bool first = std::any_of(combinations_.begin(), combinations_.end(), [&](const Combination& c) {
      return seeks_first_hit(c) && c.expected <= time - first_end_;
    });
    Combination* best = nullptr;
    for (Combination& c : combinations_)
      if (!c.over && c.expected <= (first ? time - first_end_ : time) && (!first || seeks_first_hit(c)) &&
          (best == nullptr || weight(c) < weight(*best)))
        best = &c;
    return time > 0 ? best : nullptr;
  }
  // The time of a combination for its next run: its equal share, or more where the run before says so. A run that fits by
  // that may go beyond the time of the first hits, as far as half more than it is thought to need.
  double turn_of(const Combination& c) const {
    const bool seeks = seeks_first_hit(c);
    const auto n = std::ranges::count_if(
        combinations_, [&](const Combination& other) { return seeks ? seeks_first_hit(other) : !other.over; });
    const double time = seeks ? left() - first_end_ : left();
    const double share = time / static_cast<double>(n);
    const double likely = std::min(4 * c.expected, std::max(time, 1.5 * c.expected));
    return std::min({left(), too_long(), std::max(likely, kFirstTurn * share)});
  }
  // s, outputs included, after which a run cannot be of use for the target.
  double too_long() const { return std::max(kTooDear * cheapest_met_, options_.quick); }

  WorkPrecisionRun run_of(const Combination& c) const {
    WorkPrecisionRun run = c.way;
    run.setting =
        run.adaptive ? options_.tolerances[c.rung] : trajectory_.length / trajectory_.outputs / options_.steps[c.rung];
    return run;
  }

  void climb(Combination& c) {
    WorkPrecisionRun run = run_of(c);
    if (options_.progress) options_.progress(label(run));
    const double begin = clocks_.clock();
    const Outcome last = measure(c, run, turn_of(c));
    if (last.unsuited) {
      leave_out(way_of(run), run.failure);
      c.over = true;
      return;
    }
    const double spent = clocks_.clock() - begin;
    if (first_ == 0) first_ = spent;
    if (last.given_up) {  // again after the others have had their turn, with more time
      c.expected = 2 * spent;
      c.handicap *= kPatience;
      c.given_up = run;
      c.over = std::isfinite(spent) && spent >= too_long();
      return;
    }
    c.given_up.reset();
    if (Combination* same = repeated_by(run)) return merge(c, *same);
    keep(run);
    advance(c, run, spent);
  }

  // The combination that made the same computation under another name; null: none did.
  Combination* repeated_by(const WorkPrecisionRun& run) {
    const auto same = std::ranges::find_if(result_.runs, [&](const WorkPrecisionRun& other) {
      return run.done() && other.done() && other.setting == run.setting && other.error == run.error &&
             other.evaluations == run.evaluations && other.steps == run.steps && !same_way(other, run) &&
             other.solver == run.solver && other.stabilization == run.stabilization &&
             (other.formulation == run.formulation || other.formulation == Formulation::automatic) &&
             integrator_type(other.integrator) == integrator_type(run.integrator);
    });
    if (same == result_.runs.end()) return nullptr;
    return &*std::ranges::find_if(combinations_, [&](const Combination& c) { return same_way(*same, c.way); });
  }

  // Ends the one with the longer name; the other has the runs of both.
  void merge(Combination& c, Combination& other) {
    c.over = true;
    if (any_done(c)) return;  // they are not the same at other settings
    std::erase_if(result_.runs, [&](const WorkPrecisionRun& run) { return same_way(run, c.way); });
    if (c.way.formulation != other.way.formulation || c.method->name.size() >= other.method->name.size()) return;
    for (WorkPrecisionRun& run : result_.runs)
      if (same_way(run, other.way)) run.integrator = c.method->name;
    std::swap(c, other), std::swap(c.method, other.method), std::swap(c.way.integrator, other.way.integrator);
  }

  void keep(const WorkPrecisionRun& run) {
    result_.runs.push_back(run);
    if (options_.measured) options_.measured(run);
  }

  Outcome measure(const Combination& c, WorkPrecisionRun& run, double limit) {
    Stabilization stabilization = options_.gains;
    stabilization.kind = run.stabilization;
    Recipe recipe{c.method, c.solver, {run.formulation, stabilization}};
    if (run.adaptive)
      recipe.tolerance = {run.setting, 1e-2 * run.setting}, recipe.step = options_.largest_step;
    else
      recipe.step = run.setting;
    Outcome out = attempt_run(trajectory_, recipe, limit, clocks_);
    note(out, run, out.cpu);
    if (!run.done()) return out;
    run.wrong = out.wrong, run.used = out.used;
    run.error = difference(out.history, reference_, length_);
    if (!std::isfinite(run.error.position)) run.failure = "the result is not finite";
    // Dense output between long steps can cost more than the steps: then the time is taken without outputs.
    const bool plain = out.dense && out.report.steps < kManySteps * trajectory_.outputs;
    double cpu = plain ? HUGE_VAL : run.cpu;
    for (int k = plain ? 0 : 1; run.done() && k < std::max(1, options_.repeats); ++k) {
      if (k > 0 && cpu > options_.quick) break;
      const Outcome again =
          attempt_run(trajectory_, recipe, limit, clocks_, plain ? RunKind::plain : RunKind::observed);
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

  // Decides whether this combination continues, and predicts the cost of its next run.
  void advance(Combination& c, const WorkPrecisionRun& run, double spent) {
    double growth = run.adaptive ? (c.last_cpu > 0 ? std::clamp(run.cpu / c.last_cpu, 1.1, 5.0) : kFirstGrowth) : 2;
    if (!run.adaptive && c.rung + 1 < n_rungs(c))
      growth = static_cast<double>(options_.steps[c.rung + 1]) / options_.steps[c.rung];
    c.expected = growth * spent;
    c.last_cpu = run.cpu;
    ++c.rung;
    c.over = c.rung >= n_rungs(c);
    if (!run.done()) return;
    if (const double e = relative(run.error); !run.wrong || e > kWrong) {  // else its error is not why
      c.n_stuck = e < kFalls * c.best ? 0 : c.n_stuck + 1;
      c.best = std::min(c.best, e);
    }
    if (c.n_stuck >= (c.best < kSettled ? 2 : 4)) c.over = true;
    if (hopeless(run)) c.over = true;
    if (options_.target <= 0) return;
    const bool meets = !run.wrong && run.error.of(options_.target_kind) <= options_.target;
    if (meets && c.met) c.over = true;
    if (meets) cheapest_met_ = std::min(cheapest_met_, run.cpu);
    if (c.last_cpu > (c.base_form ? kTooDear : 1) * cheapest_met_) c.over = true;
    c.met = meets;
  }

  // Largest relative error; errors below the agreement of the references count as that.
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
    if (relative(run.error) > kWrong) return false;  // such errors are cheap
    return std::any_of(result_.runs.begin(), result_.runs.end(), [&](const WorkPrecisionRun& other) {
      return other.done() && !other.wrong && relative(other.error) <= relative(run.error) &&
             run.cpu > options_.hopeless * other.cpu;
    });
  }

  bool any_done(const Combination& c) const {
    return std::ranges::any_of(result_.runs,
                               [&](const WorkPrecisionRun& run) { return run.done() && same_way(run, c.way); });
  }

  const Trajectory& trajectory_;
  const WorkPrecisionOptions& options_;
  Clocks clocks_;
  double begin_;
  double length_ = 1, cheapest_met_ = HUGE_VAL;
  double first_end_ = 0;  // s that are left of the budget when the time of the first hits is over
  double first_ = 0;      // s of the very first run: the expected cost of a combination that has not begun
  History reference_;
  std::vector<Combination> combinations_;
  WorkPrecision result_;
};

}  // namespace

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double HistoryError::of(ErrorKind kind) const {
  const double all[] = {position, velocity, energy, reaction};
  return all[static_cast<std::size_t>(kind)];
}

bool same_way(const WorkPrecisionRun& a, const WorkPrecisionRun& b) {
  return a.integrator == b.integrator && a.solver == b.solver && a.formulation == b.formulation &&
         a.stabilization == b.stabilization;
}

std::string integrator_type(const std::string& integrator) { return integrator.substr(0, integrator.find(':')); }

WorkPrecision work_precision(const Trajectory& trajectory, const WorkPrecisionOptions& options) {
  if (!(trajectory.length > 0) || trajectory.outputs < 1)
    throw ModelError(
        fmt::format("a chart of {} s with {} outputs has no history; give a length > 0 and at least one output",
                    trajectory.length, trajectory.outputs));
  if (options.integrators.empty() || options.solvers.empty() || options.formulations.empty() ||
      options.stabilizations.empty() || options.references.empty())
    throw ModelError(
        "a chart needs an integrator, a solver, a formulation, a stabilisation and a reference; give one of each");
  if (options.tolerances.empty() || options.steps.empty())
    throw ModelError("a chart needs tolerances and steps; give at least one of each");
  return Benchmark(trajectory, options).run();
}

}  // namespace lockstep
