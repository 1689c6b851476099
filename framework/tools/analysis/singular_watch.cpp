#include "framework/tools/analysis/singular_watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include <lockstep/error.h>
#include "framework/dynamics/solvers/graph.h"
#include "framework/tools/analysis/doubts.h"
#include "framework/tools/analysis/fading_rows.h"

namespace lockstep {

namespace {

constexpr double kLook = 0.02;        // rad between two looks
constexpr double kLow = 0.3;          // of the largest root so far: a minimum below it is looked at
constexpr double kBeside = 5;         // per rad: what a root is less than where a position lies within that turn
constexpr double kIsSingular = 1e-3;  // root of the indicator in a singular position; what is left is the search's
constexpr int kSearch = 24;           // halvings by the golden section: 1e-5 of the interval
constexpr double kGolden = 0.6180339887498949;
constexpr double kOnConstraints = 1e-12;  // m, times the length

bool has_no_rows(const Sample& sample) { return sample.state.coordinates && !sample.state.coordinates->has_rows(); }

// The state of a sample in the bodies' own coordinates.
State in_slots(const Sample& sample) {
  State state = sample.state;
  sample.dynamics().to_slots(state);
  return state;
}

// The speed of the fastest body, rad/s; translations over the length of the mechanism.
double fastest(const Inputs& in, double length) {
  double w2 = 0;
  for (const Motion& O : in.motions) w2 = std::max({w2, O.v.squaredNorm() / (length * length), O.w.squaredNorm()});
  return std::sqrt(w2);
}

// The turn of the fastest body in a time, rad.
double turn_in(const State& state, double h, double length) {
  double w2 = 0;
  for (Eigen::Index i = 0; i < state.v.size(); i += 6)
    w2 = std::max(
        {w2, state.v.segment<3>(i).squaredNorm() / (length * length), state.v.segment<3>(i + 3).squaredNorm()});
  return h * std::sqrt(w2);
}

}  // namespace

// An evaluation and a factor of its own, which the run does not see.
struct SingularWatch::Eye {
  Eye(System& system, const State& state)
      : evaluation(system, state), factor(system, solver, Formulation::omega, work), project(1e-8 * system.length()) {}

  /// Links in force at its last look.
  std::vector<bool> modes() const { return evaluation.layout() ? evaluation.layout()->modes : std::vector<bool>(); }
  double root_at(const State& state) {
    evaluation.at(state);
    factor.compute(evaluation);
    SolveReport report;
    factor.complete(report);
    return std::sqrt(std::max(report.detector, 0.0));
  }
  /// Along the velocity for a time, and back onto the constraints.
  double root_beside(const State& from, double time, State& at) {
    at = from;
    advance_state(at, time, from.v);
    at.t = from.t + time;
    try {
      if (!project.project(evaluation, factor, at, kOnConstraints * evaluation.system().length()).converged)
        return HUGE_VAL;
      return root_at(at);
    } catch (const Error&) {
      return HUGE_VAL;
    }
  }

  WorkCount work;
  SchurSolver solver;
  Evaluation evaluation;
  Factor factor;
  Projection project;
};

SingularWatch::SingularWatch(System& system) : system_(system) {}
SingularWatch::~SingularWatch() = default;

bool SingularWatch::is_needed(const Dynamics& dynamics, const State& state, const IntegratorInfo& method) {
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  return !(method.passes_singular && projects) && has_loops(dynamics.system(), state.modes);
}

void SingularWatch::start(const Sample& sample) {
  passed_.clear(), n_passed_ = 0;
  forget();
  if (has_no_rows(sample)) return;
  const State state = in_slots(sample);
  eye_ = std::make_unique<Eye>(system_, state);
  look(state, 0);
}

void SingularWatch::jumped(const Sample&) { forget(); }

void SingularWatch::save(Snapshot& out) const {
  for (const Look* l : {&before_, &last_, &regular_}) {
    out.put(l->root), out.put(l->turn);
    put_state(l->state, out);
  }
  out.put(turned_);
  out.put(static_cast<double>(n_passed_)), out.put(static_cast<double>(passed_.size()));
  for (const PassedPosition& p : passed_) {
    out.put(p.t), out.put(p.indicator), out.put(static_cast<double>(p.links.size()));
    for (const std::string& link : p.links) out.put_text(link);
  }
  Snapshot learned;
  if (eye_) eye_->factor.save(eye_->evaluation, learned);
  out.put_all(eye_ ? eye_->modes() : std::vector<bool>()), out.put_part(learned);
}

void SingularWatch::load(SnapshotReader& in) {
  for (Look* l : {&before_, &last_, &regular_}) {
    l->root = in.get(), l->turn = in.get();
    get_state(l->state, in);
  }
  turned_ = in.get();
  n_passed_ = in.get_count();
  passed_.assign(static_cast<std::size_t>(in.get_count()), {});
  for (PassedPosition& p : passed_) {
    p.t = in.get(), p.indicator = in.get();
    p.links.resize(static_cast<std::size_t>(in.get_count()));
    for (std::string& link : p.links) link = in.get_text();
  }
  // What the solver knew of other links in force than the present ones was forgotten at the next look.
  std::vector<bool> modes;
  in.get_all(modes);
  SnapshotReader learned = in.get_part();
  if (!eye_) return;
  if (modes == eye_->modes())
    eye_->factor.restore(eye_->evaluation, learned);
  else
    eye_.reset();
}

// What was seen of other links in force, or before an impact, says nothing of what follows.
void SingularWatch::forget() {
  before_.root = last_.root = regular_.root = -1;
  turned_ = 0;
}

void SingularWatch::step(const Sample& sample) {
  if (has_no_rows(sample) || sample.report.manifold) return forget();
  if (!eye_) eye_ = std::make_unique<Eye>(system_, in_slots(sample));
  const double turn = sample.report.h * fastest(sample.inputs(), system_.length());
  turned_ += turn;
  if (turned_ < kLook) return;
  turned_ = 0;
  look(in_slots(sample), turn);
}

void SingularWatch::look(const State& state, double turn) {
  Look now{state, 0, turn};
  try {
    now.root = eye_->root_at(now.state);
  } catch (const Error&) {
    return;
  }
  // The first look may lie beside a position too: then there is nothing before it to compare with.
  const bool first = before_.root < 0;
  const bool was_lowest = last_.root >= 0 && (first || last_.root <= before_.root) && last_.root < now.root;
  const bool beside = last_.root < kBeside * std::max(kLook, turn);
  if (was_lowest && (beside || (!first && last_.root < kLow * std::max(regular_.root, now.root))))
    find_between(first ? last_ : before_, last_, now);
  if (now.root > regular_.root) regular_ = now;
  before_ = std::move(last_);
  last_ = std::move(now);
}

// The root of the indicator falls as the distance: it has the shape of a V, whose tip the golden section finds.
void SingularWatch::find_between(const Look& before, const Look& lowest, const Look& after) {
  double a = before.state.t - lowest.state.t, b = after.state.t - lowest.state.t;
  State at, best = lowest.state;
  double least = lowest.root;
  const auto root = [&](double time) {
    const double r = eye_->root_beside(lowest.state, time, at);
    if (r < least) least = r, best = at;
    return r;
  };
  double x = b - kGolden * (b - a), y = a + kGolden * (b - a), fx = root(x), fy = root(y);
  for (int k = 0; k < kSearch && least > 0.01 * kIsSingular; ++k) {
    if (fx < fy) {
      b = y, y = x, fy = fx, x = b - kGolden * (b - a), fx = root(x);
    } else {
      a = x, x = y, fx = fy, y = a + kGolden * (b - a), fy = root(y);
    }
  }
  // Steps over a place that is nearly one do not see it either: its distance, by the slope beside it, is less than the turn
  // of a step.
  const double turn = std::max(lowest.turn, after.turn), slope = std::max(before.root, after.root) - least;
  const double apart = turn_in(lowest.state, after.state.t - before.state.t, system_.length());
  const bool at_first_look = best.t == before.state.t;  // a start in a position is told by itself
  const bool stepped_over = slope > 0 && least * apart < slope * turn && turn > kLook && least < 0.1 * regular_.root;
  if (at_first_look || (!(least < kIsSingular) && !stepped_over)) return;
  ++n_passed_;
  if (passed_.size() == kKept) return;
  passed_.push_back({best.t, least * least, {}});
  try {
    passed_.back().links = fading_links(system_, regular_.state, best);
  } catch (const Error&) {  // where no row can be evaluated none is named
  }
}

std::string passed_words(const std::vector<PassedPosition>& passed, long n, const IntegratorInfo& method,
                         bool projects) {
  std::vector<double> times;
  std::vector<std::string> links;
  for (const PassedPosition& p : passed) {
    times.push_back(p.t);
    for (const std::string& name : p.links)
      if (std::ranges::find(links, name) == links.end()) links.push_back(name);
  }
  const std::string where = links.empty() ? "" : fmt::format(" (links {})", first_of(links));
  const char* next = !projects ? "--stabilization project with --integrator dop853"
                     : method.name == "dop853" || method.name == "dopri5" ? "stages auto, and no fixed steps"
                                                                          : "--integrator dop853";
  return fmt::format(
      "passed {} singular position{} with plain stages, at t = {}{}; the motion after {} may be another: take {}", n,
      n == 1 ? "" : "s", times_of(times, static_cast<std::size_t>(n)), where, n == 1 ? "it" : "them", next);
}

}  // namespace lockstep
