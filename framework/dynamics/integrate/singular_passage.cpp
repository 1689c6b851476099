// SPDX-License-Identifier: BSD-3-Clause
#include "framework/dynamics/integrate/singular_passage.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <exception>
#include <utility>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/speed_of.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

namespace {

constexpr double kTurn = 0.5;   // rad per step, with the stages on the constraints
constexpr double kRegular = 3;  // times near_singular_below(), at which stages leave the constraints again

double round_off(double distance) { return SingularRate::round_off(distance); }

}  // namespace

void SingularPassage::begin(const Tableau& tableau, const State& state, Dynamics& dynamics) {
  const bool projects = dynamics.options().stabilization.kind == Stabilization::Kind::project;
  const bool has_rows = !state.coordinates || state.coordinates->has_rows();
  active_ = has_rows && (when_ == StagesWhen::manifold ||
                         (when_ == StagesWhen::automatic && projects && has_loops(dynamics.system(), state.modes)));
  near_ = begun_ = on_constraints_ = false;
  seen_ = {}, below_ = 0;
  if (!active_) return;
  ask(dynamics, state);
  a_.clear();
  for (int i = 0; i < tableau.n_all; ++i) a_.emplace_back(tableau.a + i * tableau.stride, i);
  stage_ = state, rate_ = sized_like(state);
  both_sides_.begin(state);
}

void SingularPassage::ask(Dynamics& dynamics, const State& state) {
  const Redundancy redundancy = dynamics.redundancy(state);
  below_ = redundancy.rows < 0 ? 0 : near_singular_below(redundancy.regular);
  on_constraints_ = redundancy.on_constraints;
}

void SingularPassage::start_step() {
  const bool always = active_ && (when_ == StagesWhen::manifold || on_constraints_);
  on_ = always || near_ ? StagesOn::manifold : StagesOn::plain;
  longer_ = 0;
}

bool SingularPassage::evaluate(Dynamics& dynamics, const State& y, double h, int first, int last, Stages& stages) {
  if (!active_) return stages.evaluate(dynamics, y, h, first, last, on_);
  if (first == 0) {
    passes::motions(dynamics.system(), y, motions_);
    rate_of_turn_ = fastest_turn(motions_);
  }
  seen_ = first == 0 ? Seen{} : first == 1 ? first_ : seen_;
  for (int i = first; i < last; ++i) {
    if (!evaluate(dynamics, y, h, i, stages)) return false;
    if (i == 0) first_ = seen_;
    if (near() && on_ == StagesOn::plain && i < stages.tableau().n_stages) break;  // to be repeated
  }
  return true;
}

// One stage. In the position itself rows contradict one another.
bool SingularPassage::evaluate(Dynamics& dynamics, const State& y, double h, int i, Stages& stages) {
  std::exception_ptr refused;
  try {
    if (!stages.evaluate(dynamics, y, h, i, i + 1, on_)) return false;
  } catch (const SolveError&) {
    if (on_ == StagesOn::plain) throw;
    refused = std::current_exception();
  }
  const Conditioning c = refused ? Conditioning{0, 0} : stages.conditioning(i);
  seen_.indicator = std::min(seen_.indicator, c.indicator()), seen_.limit = false;
  const double by_detector = round_off(std::sqrt(c.detector));
  if (on_ == StagesOn::plain || by_detector < relative_) return true;
  if (!near()) return seen_.accuracy += by_detector, true;
  if (y.z.size() > 0) stage_.z = y.z;
  stages.combine(y, h, a_[i], stage_);
  stage_.t = y.t + stages.tableau().c[i] * h;
  const Sides sides = both_sides_.find(dynamics, stage_, c.detector, rate_);
  constexpr double d = SingularRate::kDelta;
  const double distance = both_sides_.distance();
  const double direct = round_off(sides == Sides::differ ? std::max(0.5 * d, std::sqrt(c.detector)) : distance);
  const double limit = std::max(both_sides_.error(), round_off(d - distance));
  seen_.limit = sides == Sides::agree && limit < direct;
  seen_.accuracy += seen_.limit ? limit : direct;
  if (seen_.limit) stages.put(i, rate_);
  if (refused && !seen_.limit) std::rethrow_exception(refused);
  // No more than proximal terms leave; or all of it is round-off.
  const auto inside = [&] { return c.detector < 10 * kProximalOfMatrix || !nearly_loses_rank(dynamics, y); };
  if (sides != Sides::differ || begun_ || i > 0 || !inside() || !loses_rank(dynamics, y)) return true;
  throw StepError(
      fmt::format("{}: at t = {:.9g} s the mechanism is in a singular configuration, or constraints are nearly "
                  "redundant: several motions continue, or none (smallest relative pivot {:.2g}); start slightly off "
                  "it with the intended velocity, or remove a redundant joint (lockstep check)",
                  method_, y.t, c.pivot),
      y.t);
}

double SingularPassage::longest(double h) const {
  return on_ == StagesOn::manifold && rate_of_turn_ > 0 ? std::min(h, kTurn / rate_of_turn_) : h;
}

bool SingularPassage::enters() {
  if (on_ == StagesOn::manifold || !near()) return false;
  on_ = StagesOn::manifold;
  return true;
}

bool SingularPassage::accepts(double h, double error) {
  if (!(error > 1)) return error <= 1;
  return error <= seen_.accuracy / relative_ && std::exchange(longer_, std::max(longer_, h)) > 0;
}

// What rounding leaves of the velocities leads off the branch, and is in the energy by its square: a step whose end is on
// the constraints as it is then needs no projection, and others end at the limit of both sides.
ProjectReport SingularPassage::land(Dynamics& dynamics, State& end) {
  if (active_ && !(below_ > 0)) ask(dynamics, end);
  const bool noisy = seen_.limit && round_off(both_sides_.distance()) * both_sides_.distance() > std::sqrt(relative_);
  if (!noisy) return project_end(dynamics, end, on_);
  dynamics.normalize(end);
  ProjectReport report{.before = dynamics.violation_of_closures(end)};
  const bool off = report.before > dynamics.options().stabilization.tolerance;
  if (off && both_sides_.find(dynamics, end, 0, rate_) != Sides::agree) return project_end(dynamics, end, on_);
  report.after = dynamics.violation_of_closures(end);
  return report;
}

void SingularPassage::finish_step(StepReport& report) {
  if (!active_) return;
  begun_ = true;
  report.h_next = std::max(report.h_next, longer_);
  near_ = when_ == StagesWhen::automatic && seen_.indicator < (on_ == StagesOn::manifold ? kRegular : 1) * below_;
  if (below_ > 0 && std::isfinite(seen_.indicator)) below_ = std::max(below_, near_singular_below(seen_.indicator));
}

}  // namespace lockstep
