#include <lockstep/dynamics.h>

#include <algorithm>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/tree/articulated.h"
#include "framework/dynamics/tree/joint_tree.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

std::unique_ptr<LinearSolver> checked(std::unique_ptr<LinearSolver> solver) {
  if (!solver) throw ModelError("dynamics: no solver was given; make one, for instance SparseSolver");
  return solver;
}

void check(const Stabilization& s) {
  if (!(s.alpha >= 0) || !(s.beta >= 0) || !(s.tolerance > 0))
    throw ModelError("stabilisation: alpha " + text::brief(s.alpha) + ", beta " + text::brief(s.beta) + ", tolerance " +
                     text::brief(s.tolerance) +
                     "; the rates must not be negative and the tolerance must be above zero");
}

}  // namespace

namespace {

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
  throw ModelError("there is no formulation '" + std::string(word) + "'; there are omega, quaternion, joint and auto");
}

SolveReport Solution::full_report() const {
  SolveReport full = report;
  factor.complete(full);
  return full;
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

Dynamics::~Dynamics() = default;

// Joint coordinates: the tree of the links that were in force last, and the recursion on it.
struct Dynamics::Tree {
  long revision = -1;  // of the system, and the links, that the tree was made for
  std::vector<bool> modes;
  std::shared_ptr<const JointTree> coordinates;  // null: there is no tree
  std::string why_not;
  ArticulatedBodies bodies;
  std::vector<Motion> motions;
  VecX f, none;
  RowTable no_rows;  // of no link
};

Dynamics::Tree& Dynamics::tree(const std::vector<bool>& modes) {
  system_.setup();
  if (!tree_) tree_ = std::make_unique<Tree>();
  Tree& t = *tree_;
  if (t.revision == system_.revision() && t.modes == modes) return t;
  t.revision = system_.revision(), t.modes = modes;
  t.coordinates = JointTree::of(system_, modes, t.why_not);
  if (t.coordinates) t.bodies.begin(*t.coordinates);
  t.f.setZero(6 * system_.n_slots());
  system_.lay_out(std::vector<bool>(modes.size(), false), t.no_rows);
  return t;
}

std::string Dynamics::why_not_joint(const std::vector<bool>& modes) { return tree(modes).why_not; }

void Dynamics::to_formulation(State& state, const State* near) {
  if (options_.formulation != Formulation::joint && options_.formulation != Formulation::automatic)
    return to_slots(state);
  const std::shared_ptr<const JointTree> wanted = tree(state.modes).coordinates;
  if (state.coordinates == wanted) return;
  to_slots(state);
  if (!wanted) return;
  State out;
  wanted->read_off(state, near && near->coordinates == wanted ? near : nullptr, out);
  out.coordinates = wanted;
  state = std::move(out);
}

void Dynamics::to_slots(State& state) {
  if (!state.coordinates) return;
  std::vector<Motion> motions;
  system_.motions(state, motions);
  state.coordinates = nullptr;
  state.q.resize(7 * system_.n_slots()), state.v.resize(6 * system_.n_slots());
  for (int k = 0; k < system_.n_slots(); ++k) {
    const Motion& O = motions[static_cast<std::size_t>(k + 1)];
    state.set_slot_pose(k, {O.x, normalized(O.e)});
    state.set_slot_twist(k, {O.v, O.w});
  }
}

// The evaluation is made at the first state.
Evaluation& Dynamics::own(const State& state) {
  if (!evaluation_) {
    evaluation_ = std::make_unique<Evaluation>(system_, state);
    solution_.emplace(
        Solution{{evaluation_->inputs(), a_, lambda_, evaluation_->rows()}, *evaluation_, factor_, SolveReport{}});
  }
  return *evaluation_;
}

Evaluation& Dynamics::gathered(const State& state) {
  const bool first = !evaluation_;
  Evaluation& e = own(state);
  if (!first) e.at(state);
  return e;
}

const Evaluation& Dynamics::gather(const State& state) {
  const Evaluation& e = gathered(state);
  e.check();
  return e;
}

const Inputs& Dynamics::inputs(const State& state) {
  system_.setup();
  system_.check_size(state);
  return inputs_.at(system_, state);
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
  if (!e.reacting().empty()) reacting_.solve(e, factor_, c_, a_, lambda_, report);
  ++work_.evaluations;
  factor_.check(e, a_, lambda_, report);
  return *solution_;
}

void Dynamics::rates(const State& state, StateRate& out) {
  if (state.coordinates)
    joint_rates(state, out);
  else
    rate(state, out);
}

void Dynamics::joint_rates(const State& state, StateRate& out) {
  Tree& t = tree(state.modes);
  if (state.coordinates != t.coordinates)
    throw ModelError(
        "a state in joint coordinates of another mechanism, or of other links in force; convert it first "
        "(Dynamics::to_slots)");
  t.bodies.outward(*t.coordinates, state, t.motions);
  Inputs in;
  in.t = state.t, in.motions = t.motions;
  in.s = {state.s.data(), static_cast<std::size_t>(state.s.size())};
  in.z = {state.z.data(), static_cast<std::size_t>(state.z.size())};
  system_.gather_forces(in, t.f);
  t.bodies.accelerate(*t.coordinates, t.motions, t.f, out.v);
  t.coordinates->kinematic_rate(state, out.q);
  out.largest_a = t.bodies.largest_a(), out.largest_alpha = t.bodies.largest_alpha();
  out.s.resize(state.s.size());
  if (state.s.size() > 0) {
    system_.state_rates({in, t.none, t.none, t.no_rows}, out.s);
    if (!out.s.allFinite()) diagnose_rates(system_, state.t, out.s);
  }
  ++work_.evaluations;
  if (out.v.allFinite()) return;
  gather(state);  // names the culprit
  throw NonFiniteError("t = " + text::number(state.t) +
                           " s: the accelerations are not finite although every force is; the motion has blown up: "
                           "take a smaller step (--step) or tolerance",
                       state.t);
}

const Solution& Dynamics::rate(const State& state, StateRate& out) {
  if (state.coordinates)
    throw ModelError(
        "Dynamics::rate takes a state in the slots' own coordinates; this one has those of the "
        "formulation '" +
        std::string(state.coordinates->name()) + "': call rates()");
  const Solution& solution = evaluate(state);
  kinematic_rate(state, out.q);
  out.v = a_;
  out.s.resize(state.s.size());
  if (state.s.size() > 0) {
    system_.state_rates(solution, out.s);
    if (!out.s.allFinite()) diagnose_rates(system_, state.t, out.s);
  }
  return solution;
}

double Dynamics::violation(const State& state) {
  const Evaluation& e = gather(state);
  e.residuals(C_, Cd_);
  return e.norm(C_);
}

double Dynamics::violation_v(const State& state) {
  const Evaluation& e = gather(state);
  e.residuals(C_, Cd_);
  return e.norm(Cd_);
}

ProjectReport Dynamics::project(State& state) { return project(state, 1e-2 * options_.stabilization.tolerance); }

ProjectReport Dynamics::project(State& state, double goal) {
  if (state.coordinates) {
    normalize_state(state);
    return {};
  }
  Evaluation& e = own(state);
  const ProjectReport report = projection_.project(e, factor_, state, goal);
  if (e.rows().n_rows > 0) ++work_.projections;
  return report;
}

double Dynamics::project_velocity(State& state) {
  if (state.coordinates) return 0;
  return projection_.project_velocity(own(state), factor_, state, 1e-3 * options_.stabilization.tolerance);
}

void Dynamics::accept(State& state) {
  if (state.z.size() == 0) return;
  system_.accept(inputs(state), state);
}

}  // namespace lockstep
