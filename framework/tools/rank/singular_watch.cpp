// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/singular_watch.h"
#include "framework/foundation/support/finding_kinds.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <lockstep/error.h>
#include <lockstep/solvers.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/evaluate/singular_rate.h"
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/loop_rows.h"

namespace lockstep {

namespace {

constexpr double kLook = 0.02;   // rad between two looks
constexpr int kRounds = 6;       // of parabolas, each of which gains more than a digit
constexpr double kUnseen = 0.1;  // of the turn of a step: about the distance of its stages
// Of a pivot, what is left of it beside a singular configuration; and of the combination of rows that fades there, the
// share below which a row takes no part, since what is left of the pivot is spread over others.
constexpr double kFaded = 0.05;

// Whether there are rows that a singular configuration could make redundant.
bool has_rows(const Sample& sample) { return !sample.state.coordinates || sample.state.coordinates->has_rows(); }

// Names of the links whose rows become dependent from a regular position to a singular one: those that take part in the
// combination of rows which fades, loop by loop. None if a loop has more than 300 rows, or no row fades.
std::vector<std::string> fading_links(System& system, const State& regular, const State& singular) {
  const Evaluation before(system, regular), there(system, singular);
  std::vector<std::string> names;
  for (const std::vector<int>& entries : loops_of(system, there.rows())) {
    const LoopRows rows(system, there.rows(), entries), usual(system, before.rows(), entries);
    if (rows.n() > kDenseRows || rows.n() != usual.n()) continue;
    const RowSpace was(usual.Jt), now(rows.Jt);
    const int rank = was.rank();
    if (rank == 0 || !(now.pivot(rank - 1) < kFaded * was.pivot(rank - 1))) continue;
    const VecX shares = now.circuit(rank - 1, rank - 1).cwiseAbs();
    for (int k = 0; k < rows.n(); ++k)
      if (shares[k] >= kFaded) add_name(NamedRow(system, there.rows(), rows.numbers[k]).link->name(), names);
  }
  return names;
}

}  // namespace

SingularWatch::SingularWatch(System& system)
    : system_(system), eye_(system, std::make_unique<SchurSolver>(), {.formulation = Formulation::omega}) {}

bool SingularWatch::is_needed(const Dynamics& dynamics, const State& state, const IntegratorInfo& method) {
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  return !(method.passes_singular && projects) && has_loops(dynamics.system(), state.modes);
}

void SingularWatch::start(const Sample& sample) {
  passed_.clear(), n_passed_ = 0;
  forget();
  if (has_rows(sample)) look(look_at(sample, 0));
}

void SingularWatch::jumped(const Sample&) { forget(); }

void SingularWatch::save(Snapshot& out) const {
  for (const Look* l : {&before_, &last_, &regular_}) {
    for (const double x : {l->indicator, l->rate, l->turn}) out.put(x);
    put_state(l->state, out);
  }
  out.put(turned_);
  out.put(static_cast<double>(n_passed_)), out.put(static_cast<double>(passed_.size()));
  for (const PassedPosition& p : passed_) {
    out.put(p.t), out.put(p.indicator), out.put(static_cast<double>(p.links.size()));
    for (const std::string& link : p.links) out.put_text(link);
  }
}

void SingularWatch::load(SnapshotReader& in) {
  for (Look* l : {&before_, &last_, &regular_}) {
    for (double* x : {&l->indicator, &l->rate, &l->turn}) *x = in.get();
    get_state(l->state, in);
  }
  turned_ = in.get();
  n_passed_ = in.get_count();
  passed_.assign(in.get_count(), {});
  for (PassedPosition& p : passed_) {
    p.t = in.get(), p.indicator = in.get();
    p.links.resize(in.get_count());
    for (std::string& link : p.links) link = in.get_text();
  }
}

// Observations of other active joints, or before an impact, do not apply to the following motion.
void SingularWatch::forget() {
  before_.indicator = last_.indicator = regular_.indicator = -1;
  turned_ = 0;
}

void SingularWatch::step(const Sample& sample) {
  if (!has_rows(sample) || sample.report.manifold) return forget();
  const double turn = sample.report.h * speed_of(sample.inputs().motions, system_.length());
  turned_ += turn;
  if (turned_ < kLook) return;
  turned_ = 0;
  look(look_at(sample, turn));
}

SingularWatch::Look SingularWatch::look_at(const Sample& sample, double turn) const {
  Look now{sample.state, 0, speed_of(sample.inputs().motions, system_.length()), turn};
  to_slot_coordinates(system_, now.state);
  return now;
}

double SingularWatch::indicator(const State& state) {
  return std::max(eye_.evaluate(state).full_report().detector, 0.0);
}

void SingularWatch::look(Look now) {
  try {
    now.indicator = indicator(now.state);
  } catch (const Error&) {
    return;
  }
  if (last_.indicator >= 0 && last_.indicator < now.indicator &&
      (before_.indicator < 0 || last_.indicator <= before_.indicator))
    find_between(before_, last_, now);
  if (now.indicator > regular_.indicator) regular_ = now;
  before_ = std::move(last_);
  last_ = std::move(now);
}

// The indicator falls as c (theta^2 + theta0^2), theta: the turn from its minimum, theta0: how far the motion passes
// the position by. The parabola through three looks has its vertex there; the first look has none before it.
void SingularWatch::find_between(const Look& before, const Look& lowest, const Look& after) {
  Look best = lowest, now;
  const auto look_at = [&](double t) {
    now.state = lowest.state, now.indicator = HUGE_VAL;
    eye_.advance(now.state, t - now.state.t, lowest.state.v);
    now.state.t = t;
    try {
      if (eye_.project(now.state, kRoundOff * system_.length()).converged) now.indicator = indicator(now.state);
    } catch (const Error&) {  // nothing is seen there
    }
    if (now.indicator < best.indicator) best = now;
    return std::pair(t, now.indicator);
  };
  using Point = std::pair<double, double>;
  std::array<Point, 3> p{
      Point{before.state.t, before.indicator}, {lowest.state.t, lowest.indicator}, {after.state.t, after.indicator}};
  if (before.indicator < 0) p[0] = p[1], p[1] = look_at(0.5 * (p[0].first + p[2].first));
  for (int k = 0; k < kRounds; ++k) {
    const double a = p[1].first - p[0].first, b = p[2].first - p[1].first;
    const double left = (p[1].second - p[0].second) / a, right = (p[2].second - p[1].second) / b;
    const double vertex = p[1].first - (left * b + right * a) / (2 * (right - left));
    if (!std::isfinite(vertex) || vertex == p[0].first || vertex == p[1].first || vertex == p[2].first) break;
    const Point x = look_at(vertex);
    if (!std::isfinite(x.second)) break;
    *std::ranges::max_element(p, {}, &Point::second) = x;
    std::ranges::sort(p);
  }
  const Look& side = before.indicator > after.indicator ? before : after;
  const double turned = side.rate * (side.state.t - best.state.t);
  const double c = (side.indicator - best.indicator) / (turned * turned),
               unseen = kUnseen * std::max(lowest.turn, after.turn);
  // A start in a position, or behind it, passes none, nor does round-off of an indicator that stays.
  if (!(best.state.t > (before.indicator < 0 ? lowest : before).state.t) ||
      !(best.indicator < std::min(c * unseen * unseen, near_singular_below(side.indicator))))
    return;
  ++n_passed_;
  if (passed_.size() == kKept) return;
  passed_.push_back({best.state.t, best.indicator, {}});
  try {
    passed_.back().links = fading_links(system_, regular_.state, best.state);
  } catch (const Error&) {  // if no row can be evaluated, none is named
  }
}

Finding finding_of(const std::vector<PassedPosition>& passed, long n, const IntegratorInfo& method, bool projects) {
  std::vector<double> times;
  std::vector<std::string> links;
  for (const PassedPosition& p : passed) {
    times.push_back(p.t);
    for (const std::string& name : p.links) add_name(name, links);
  }
  const std::string where = links.empty() ? "" : fmt::format(" (joints {})", first_of(links));
  const char* next = !projects ? "--stabilization project with --integrator dop853"
                     : method.name == "dop853" || method.name == "dopri5" ? "stages auto, and no fixed steps"
                                                                          : "--integrator dop853";
  Finding f{
      &finding::singular_passed, "",
      fmt::format("passed {} singular configuration{} with unprojected stages, at t = {}{}; the motion after {} may be "
                  "on another branch",
                  n, n == 1 ? "" : "s", times_of(times, static_cast<std::size_t>(n)), where, n == 1 ? "it" : "them"),
      std::string("use ") + next};
  f.t = times.front();
  return f;
}

}  // namespace lockstep
