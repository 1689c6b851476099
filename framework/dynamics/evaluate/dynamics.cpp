// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/dynamics.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/joint_coordinates.h"  // complete where a Dynamics is made
#include "framework/dynamics/evaluate/projection_rule.h"
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

std::unique_ptr<LinearSolver> checked(std::unique_ptr<LinearSolver> solver) {
  if (!solver) throw ModelError("dynamics: no solver is given; create one, such as SparseSolver");
  return solver;
}

void check(const Stabilization& s) {
  if (!(s.alpha >= 0) || !(s.beta >= 0) || !(s.tolerance > 0))
    throw ModelError("stabilisation: alpha " + text::brief(s.alpha) + ", beta " + text::brief(s.beta) + ", tolerance " +
                     text::brief(s.tolerance) + "; alpha and beta must be 0 or more, the tolerance must be above 0");
}

constexpr std::pair<Formulation, const char*> kFormulations[] = {{Formulation::omega, "omega"},
                                                                 {Formulation::quaternion, "quaternion"},
                                                                 {Formulation::joint, "joint"},
                                                                 {Formulation::automatic, "auto"}};

}  // namespace

std::string to_string(Formulation f) {
  return std::ranges::find(kFormulations, f, &std::pair<Formulation, const char*>::first)->second;
}

Formulation formulation_from(std::string_view word) {
  for (const auto& [formulation, name] : kFormulations)
    if (word == name) return formulation;
  throw ModelError("unknown formulation '" + std::string(word) + "'; use " + text::join(formulation_names(), " or "));
}

std::vector<std::string> formulation_names() {
  std::vector<std::string> names;
  for (const auto& [formulation, name] : kFormulations) names.emplace_back(name);
  return names;
}

Dynamics::Dynamics(System& system, std::unique_ptr<LinearSolver> solver, DynamicsOptions options)
    : system_(system),
      solver_(checked(std::move(solver))),
      options_(options),
      factor_(new_factor()),
      projection_(options.stabilization.tolerance) {
  check(options_.stabilization);
  system_.setup();
}

// The evaluation is made for the first state.
Evaluation& Dynamics::own() {
  if (!evaluation_) {
    evaluation_ = std::make_unique<Evaluation>(system_);
    solution_.emplace(
        Solution{{evaluation_->inputs(), a_, lambda_, evaluation_->rows()}, *evaluation_, factor_, SolveReport{}});
  }
  return *evaluation_;
}

Evaluation& Dynamics::gathered(const State& state) {
  Evaluation& e = own();
  e.at(state);
  if (e.redundant() != Kkt::kUnknown) return e;
  e.residuals(C_, Cd_);
  if (e.norm(C_) > kOnConstraints * system_.length()) return e;
  State slots = state;
  to_slots(slots);
  const Redundancy found = redundancy(slots);  // which may gather elsewhere
  e.at(state);
  e.set_redundant(found.rows, found.nearly);
  return e;
}

const Evaluation& Dynamics::gather(const State& state) {
  const Evaluation& e = gathered(state);
  e.check();
  return e;
}

const Evaluation& Dynamics::gather_rows(const State& state) {
  Evaluation& e = own();
  e.rows_at(state);
  e.check();
  return e;
}

void Dynamics::forget_rows(const State& state) {
  if (!state.coordinates) return;
  solution_.reset();
  evaluation_ = nullptr;
  factor_.forget();
  projection_ = Projection(options_.stabilization.tolerance);
  for (VecX* x : {&a_, &lambda_, &c_, &C_, &Cd_}) *x = VecX();
}

const Inputs& Dynamics::inputs(const State& state) {
  system_.setup();
  system_.check_size(state);
  return read(state);
}

Factor& Dynamics::factor(const Evaluation& e) {
  factor_.compute(e);
  return factor_;
}

const Solution& Dynamics::evaluate(const State& state) {
  const Evaluation& e = gathered(state);
  factor_.compute(e);
  // c = Qhat + Qs; Qs = -2 alpha Cd - beta^2 C (2.15)
  c_.resize(e.rows().n_rows);
  for (const RowEntry& entry : e.rows().entries) {
    const RowView block = e.rows().block(entry);
    for (int k = 0; k < entry.m; ++k) c_[entry.first_row + k] = block.Qhat(k);
  }
  const Stabilization& s = options_.stabilization;
  if (s.kind == Stabilization::Kind::baumgarte) {
    e.residuals(C_, Cd_);
    c_ -= 2.0 * s.alpha * Cd_ + s.beta * s.beta * C_;
  }
  SolveReport& report = solution_->report;
  report = factor_.solve_motion(e, e.force(), c_, a_, lambda_);
  solution_->uncertainty = 0;
  if (!e.reacting().empty()) reacting_.solve(e, factor_, c_, a_, lambda_, report);
  ++work_.evaluations;
  factor_.check(e, a_, lambda_, report);
  return *solution_;
}

const Solution& Dynamics::rate(const State& state, StateRate& out) {
  if (state.coordinates)
    throw ModelError("Dynamics::rate takes a state in body coordinates; this one has those of the formulation '" +
                     std::string(state.coordinates->name()) + "': call rates()");
  const Solution& solution = evaluate(state);
  kinematic_rate(state, out.q);
  out.v = a_;
  out.s.resize(state.s.size());
  if (state.s.size() > 0) {
    passes::state_rates(system_, solution, out.s);
    if (!out.s.allFinite()) diagnose_rates(system_, state.t, out.s);
  }
  return solution;
}

double Dynamics::violation(const State& state) {
  const Evaluation& e = gather_rows(state);
  e.residuals(C_, Cd_);
  return e.norm(C_);
}

// If a number is not finite, all rows are gathered to name its origin.
double Dynamics::violation_of_closures(const State& state) {
  check_state(system_, state);
  if (!state.coordinates) return violation(state);
  if (!state.coordinates->has_rows()) return 0;
  const double found = tree(state.modes).of(state).violation(system_, state);
  return std::isfinite(found) ? found : violation(state);
}

double Dynamics::violation_v(const State& state) {
  const Evaluation& e = gather_rows(state);
  e.residuals(C_, Cd_);
  return e.norm(Cd_);
}

ProjectReport Dynamics::project(State& state) {
  return project(state, position_goal_of(options_.stabilization.tolerance));
}

ProjectReport Dynamics::project(State& state, double goal) {
  check_state(system_, state);
  if (state.coordinates) return project_joint(state, goal);
  Evaluation& e = own();
  const ProjectReport report = projection_.project(e, factor_, state, goal);
  if (e.rows().n_rows > 0) ++work_.projections;
  return report;
}

// Where joints do not come onto the closures, bodies may: their own coordinates are projected then.
ProjectReport Dynamics::project_joint(State& state, double goal) {
  if (!state.coordinates->has_rows()) {
    normalize_state(state);
    return {};
  }
  ++work_.projections;
  Tree& t = tree(state.modes).of(state);
  t.before = state;
  const ProjectReport report = t.project(system_, state, goal, options_.stabilization.tolerance);
  if (report.converged && t.velocities_met) return report;
  state = t.before;
  State slots = t.before;  // stays as it is where this throws
  to_slots(slots);
  const ProjectReport of_slots = projection_.project(own(), factor_, slots, goal);
  to_formulation(slots, &t.before);
  state = std::move(slots);
  return of_slots;
}

double Dynamics::project_velocity(State& state) {
  check_state(system_, state);
  const double goal = velocity_goal_of(options_.stabilization.tolerance);
  if (!state.coordinates) return projection_.project_velocity(own(), factor_, state, goal);
  if (!state.coordinates->has_rows()) return 0;
  Tree& t = tree(state.modes).of(state);
  t.before = state;
  const double left = t.project_velocity(system_, state, goal);
  if (t.velocities_met) return left;
  State slots = state = t.before;
  to_slots(slots);
  const double of_slots = projection_.project_velocity(own(), factor_, slots, goal);
  to_formulation(slots, &t.before);
  state = std::move(slots);
  return of_slots;
}

const Inputs* Dynamics::accept(State& state) {
  check_state(system_, state);
  if (!passes::keeps_anything(system_)) return nullptr;
  const Inputs& in = read(state);
  passes::accept(system_, in, state);
  if (tree_) tree_->kept.s = state.s;  // corrected, which moves nothing
  return &in;
}

void Dynamics::save(Snapshot& out) const {
  for (const long n : {work_.evaluations, work_.factors, work_.projections, work_.corrections})
    out.put(static_cast<double>(n));
}

void Dynamics::restore(SnapshotReader& in) {
  for (long* n : {&work_.evaluations, &work_.factors, &work_.projections, &work_.corrections}) *n = in.get_count();
}

void Dynamics::save_state(const State& state, Snapshot& out) const {
  out.put(state.coordinates ? 1 : 0);
  put_state(state, out);
}

void Dynamics::load_state(State& state, SnapshotReader& in) {
  set_up();
  State read;
  const bool other_coordinates = in.get_flag();
  get_state(read, in);
  const State own = system_.start();
  const bool fits = read.modes.size() == own.modes.size() && read.watched.size() == own.watched.size();
  if (fits && other_coordinates) read.coordinates = tree(read.modes).coordinates;
  const Eigen::Index n_q = read.coordinates ? read.coordinates->n_q() : own.q.size();
  const Eigen::Index n_v = read.coordinates ? read.coordinates->n_v() : own.v.size();
  if (!fits || other_coordinates != (read.coordinates != nullptr) || read.q.size() != n_q || read.v.size() != n_v ||
      read.s.size() != own.s.size() || read.z.size() != own.z.size())
    throw ModelError(
        "the saved state does not fit the system; load it into the same mechanism with the same recorded columns");
  if (!std::isfinite(read.t) || !read.q.allFinite() || !read.v.allFinite())
    throw ModelError("the saved state is not finite: the checkpoint is damaged; use an older one");
  state = std::move(read);
}

}  // namespace lockstep
