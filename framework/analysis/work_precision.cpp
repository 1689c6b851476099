#include "framework/analysis/work_precision.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <set>

#include "framework/record/channel.h"
#include "framework/support/error.h"

namespace lockstep {
namespace {

/// What a run leaves behind at the output times.
struct History {
  std::vector<double> t, energy;
  std::vector<VecX> q, v;
};

class HistoryObserver final : public Observer {
 public:
  HistoryObserver(Channel energy, History& to) : energy_(std::move(energy)), to_(to) {}
  void output(const Sample& s) override {
    to_.t.push_back(s.state.t), to_.q.push_back(s.state.q), to_.v.push_back(s.state.v);
    to_.energy.push_back(energy_.value(s));
  }

 private:
  Channel energy_;
  History& to_;
};

Quat turn_of(const VecX& q, Eigen::Index slot) { return Quat::from(q.segment<4>(7 * slot + 3)); }

// Largest difference of two histories; infinite when they do not cover the same instants or a number is not finite.
HistoryError difference(const History& a, const History& b, double length) {
  HistoryError e;
  const auto take = [](double& most, double x) { most = std::isfinite(x) ? std::max(most, x) : HUGE_VAL; };
  if (a.t.size() != b.t.size()) return {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  for (std::size_t i = 0; i < a.t.size(); ++i) {
    for (Eigen::Index k = 0; k < a.v[i].size() / 6; ++k) {
      take(e.position, (a.q[i].segment<3>(7 * k) - b.q[i].segment<3>(7 * k)).norm());
      const Quat between = conjugate(turn_of(b.q[i], k)) * turn_of(a.q[i], k);
      take(e.position, length * 2.0 * std::atan2(between.vec().norm(), std::abs(between.w)));
      take(e.velocity, (a.v[i].segment<3>(6 * k) - b.v[i].segment<3>(6 * k)).norm());
      take(e.velocity, length * (a.v[i].segment<3>(6 * k + 3) - b.v[i].segment<3>(6 * k + 3)).norm());
    }
    take(e.energy, std::abs(a.energy[i] - b.energy[i]));
  }
  return e;
}

HistoryError size_of(const History& h, double length) {
  History still;
  const std::size_t n = h.t.size();
  still.t = h.t, still.energy.assign(n, h.energy.front()), still.q.assign(n, h.q.front());
  still.v.assign(n, VecX::Zero(h.v.front().size()));
  return difference(h, still, length);
}

/// One way to run: a rung of the ladder of one combination.
struct Recipe {
  const MethodChoice* method;
  const SolverChoice* solver;
  DynamicsOptions dynamics;
  Tolerance tolerance;
  double step = 0;
};

struct Outcome {
  History history;
  double cpu = 0;
  long evaluations = 0;
  SimulationReport report;
  std::string failure;
};

std::vector<double> output_times(const Course& course) {
  std::vector<double> times;
  for (int k = 0; k <= course.outputs; ++k) times.push_back(course.length * k / course.outputs);
  return times;
}

// `limit`: s of CPU after which the run is given up.
Outcome run_once(const Course& course, const Recipe& recipe, double limit, bool truth = false) {
  Outcome out;
  const Subject subject = truth && course.truth ? course.truth() : course.make();
  HistoryObserver observer(make_channel(*subject.system, "energy.total"), out.history);
  Dynamics dynamics(*subject.system, recipe.solver->make(), recipe.dynamics);
  Simulation sim(dynamics, recipe.method->make(),
                 {.step = recipe.step, .tolerance = recipe.tolerance, .output_times = output_times(course)});
  sim.set_state(subject.start);
  for (Observer* o : subject.observers) sim.add_observer(*o);
  sim.add_observer(observer);
  for (const Event& event : subject.events) sim.add_event(event);
  const double begin = thread_seconds();
  bool given_up = false;
  sim.progress = [&](const State&) { return !(given_up = thread_seconds() - begin > limit); };
  try {
    sim.run_until(course.length);
  } catch (const Error& error) {
    out.failure = error.what();
  }
  out.cpu = thread_seconds() - begin;
  out.evaluations = dynamics.work().evaluations;
  out.report = sim.report();
  if (given_up)
    out.failure = fmt::format("given up after {:.2g} s of computing", out.cpu);
  else if (out.failure.empty() && out.report.stopped)
    out.failure = "stopped by '" + out.report.stopped_by + "' before the end";
  return out;
}

double clock_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// All combinations, rung by rung, as long as there is time.
class Survey {
 public:
  Survey(const Course& course, const WorkPrecisionOptions& options)
      : course_(course), options_(options), begin_(clock_seconds()) {}

  WorkPrecision run() {
    make_reference();
    plan();
    for (std::size_t rung = 0; rung < std::max(options_.tolerances.size(), options_.steps.size()); ++rung)
      for (Lane& lane : lanes_) climb(lane, rung);
    return std::move(result_);
  }

 private:
  struct Lane {  // one combination
    const MethodChoice* method;
    const SolverChoice* solver;
    Formulation formulation;
    Stabilization::Kind kind;
    bool adaptive;
    double last_cpu = 0;  // of the rung before
    bool closed = false;  // the next rung would not fit
  };

  void make_reference() {
    Stabilization tight = options_.gains;
    tight.kind = Stabilization::Kind::project;
    tight.tolerance = std::min(tight.tolerance, 1e-12);
    const SolverChoice& solver = options_.solvers.front();
    const auto tightest = [&](const MethodChoice& method) {
      const double r = options_.reference_tolerance;
      Outcome out = run_once(course_, {&method, &solver, {Formulation::omega, tight}, {r, 1e-2 * r}, 0},
                             0.5 * options_.budget, true);
      if (!out.failure.empty())
        throw StepError("the reference by " + method.name + " at a tolerance of " + fmt::format("{:g}", r) +
                            " cannot be made: " + out.failure + "; chart a shorter run, or give a larger budget",
                        out.history.t.empty() ? 0.0 : out.history.t.back());
      return out.history;
    };
    tell("reference: " + options_.reference.name);
    reference_ = tightest(options_.reference);
    tell("reference: " + options_.second.name);
    const Subject subject = course_.make();
    length_ = subject.system->length();
    result_.reference = options_.reference.name, result_.second = options_.second.name;
    result_.agreement = difference(tightest(options_.second), reference_, length_);
    result_.size = size_of(reference_, length_);
  }

  void plan() {
    for (const MethodChoice& method : options_.integrators)
      for (const Formulation formulation : options_.formulations)
        for (const Stabilization::Kind kind : options_.stabilizations)
          for (const SolverChoice& solver : options_.solvers)
            lanes_.push_back({&method, &solver, formulation, kind, method.make()->info().adaptive});
  }

  void climb(Lane& lane, std::size_t rung) {
    const std::size_t rungs = lane.adaptive ? options_.tolerances.size() : options_.steps.size();
    if (rung >= rungs) return;
    WorkPrecisionRun run;
    run.integrator = lane.method->name, run.solver = lane.solver->name;
    run.formulation = lane.formulation, run.stabilization = lane.kind, run.adaptive = lane.adaptive;
    run.setting = lane.adaptive ? options_.tolerances[rung] : course_.length / course_.outputs / options_.steps[rung];
    // A rung costs about twice the one before; no combination may take more than its share of what is left.
    const double left = options_.budget - (clock_seconds() - begin_);
    const double share = left / std::max<double>(1.0, static_cast<double>(open_lanes()));
    if (lane.closed || left <= 0 || 2 * lane.last_cpu > share) {
      lane.closed = true;
      result_.left_out.push_back(label(run));
      return;
    }
    tell(label(run));
    measure(lane, run, std::max(4 * share, 0.05));
    lane.last_cpu = run.cpu;
    result_.runs.push_back(run);
  }

  void measure(const Lane& lane, WorkPrecisionRun& run, double limit) {
    Stabilization stabilization = options_.gains;
    stabilization.kind = lane.kind;
    Recipe recipe{lane.method, lane.solver, {lane.formulation, stabilization}, {}, 0};
    if (lane.adaptive)
      recipe.tolerance = {run.setting, 1e-2 * run.setting};
    else
      recipe.step = run.setting;
    for (int k = 0; k < std::max(1, options_.repeats); ++k) {
      const Outcome out = run_once(course_, recipe, limit);
      run.cpu = k == 0 ? out.cpu : std::min(run.cpu, out.cpu);
      run.failure = out.failure;
      run.evaluations = out.evaluations, run.steps = out.report.steps, run.rejected = out.report.rejected;
      if (!run.done()) break;
      run.error = difference(out.history, reference_, length_);
      if (!std::isfinite(run.error.position)) run.failure = "numbers that are not finite";
      if (!run.done() || run.cpu > options_.quick) break;
    }
  }

  std::size_t open_lanes() const {
    return static_cast<std::size_t>(
        std::count_if(lanes_.begin(), lanes_.end(), [](const Lane& l) { return !l.closed; }));
  }
  void tell(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }

  const Course& course_;
  const WorkPrecisionOptions& options_;
  double begin_;
  double length_ = 1;
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

WorkPrecision work_precision(const Course& course, const WorkPrecisionOptions& options) {
  if (!(course.length > 0) || course.outputs < 1)
    throw ModelError(
        fmt::format("a chart of {} s with {} outputs has no history; give a length > 0 and an output at least",
                    course.length, course.outputs));
  if (options.integrators.empty() || options.solvers.empty() || !options.reference.make || !options.second.make)
    throw ModelError("a chart needs an integrator, a solver and two references; take them from the registry");
  return Survey(course, options).run();
}

const WorkPrecisionRun* cheapest(const WorkPrecision& result, double error) {
  const WorkPrecisionRun* best = nullptr;
  for (const WorkPrecisionRun& run : result.runs)
    if (run.done() && run.error.position <= error && (best == nullptr || run.cpu < best->cpu)) best = &run;
  return best;
}

}  // namespace lockstep
