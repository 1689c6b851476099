// SPDX-License-Identifier: BSD-3-Clause
// The coordinates of a state: conversions, and the rates in joint coordinates.

#include <algorithm>
#include <cmath>
#include <utility>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/joint_coordinates.h"
#include "framework/dynamics/evaluate/slot_coordinates.h"
#include "framework/dynamics/tree/rows_in_plane.h"
#include "framework/mechanism/rows/loads.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

namespace {

// The rates of slots that laws move, world axes: velocities, and their rates. a: 6 per slot, as in Evaluated.
void write_followed(std::span<const int> slots, std::span<const Motion> motions, const VecX& a, VecX& out) {
  if (out.size() != 12 * static_cast<Eigen::Index>(slots.size())) return;
  Eigen::Index at = 0;
  for (const int slot : slots) {
    const Motion& O = motions[slot + 1];
    out.segment<3>(at) = O.v, out.segment<3>(at + 3) = O.A * O.w;
    out.segment<3>(at + 6) = a.segment<3>(6 * slot), out.segment<3>(at + 9) = O.A * a.segment<3>(6 * slot + 3);
    at += 12;
  }
}

// The axis k of both markers about which the joint of a node turns its slot, by itself or by its laws; -1: it is none of
// them.
int axis_of(const TreeNode& n) {
  const Jointed* const joint = n.lock != nullptr && !n.moving ? n.lock->jointed() : nullptr;
  if (joint == nullptr || joint->imposed().turn || joint->imposed().hold) return -1;
  for (int k = 0; k < 3; ++k)
    if (includes(joint->rows() | row_bit(3 + k), Mask::e123) &&
        std::ranges::all_of(joint->imposed().drives, [k](const Drive& drive) {
          return !is_rotation(drive.axis) || axis_index(drive.axis) % 3 == k;
        }))
      return k;
  return -1;
}

}  // namespace

Dynamics::~Dynamics() = default;

Dynamics::Tree& Dynamics::tree(const std::vector<bool>& modes) {
  system_.setup();
  if (modes.size() != system_.links().size())
    throw ModelError("a state of " + std::to_string(modes.size()) + " joints does not fit the system, which has " +
                     std::to_string(system_.links().size()) + " after a change; take a new one from System::start");
  if (!tree_) tree_ = std::make_unique<Tree>();
  Tree& t = *tree_;
  if (t.revision == system_.revision() && t.modes == modes) return t;
  t.revision = -1, t.modes = modes;  // the revision when all of it is made
  t.coordinates = nullptr, t.recursion = nullptr, t.keeps = false;
  const bool asked = options_.formulation == Formulation::joint;
  TreeLayout layout = lay_out_tree(system_, modes, asked ? Taken::all : Taken::where_cheaper);
  t.why_not = std::move(layout.why_not), t.closure_rows = std::move(layout.closures);
  t.f.setZero(6 * system_.n_slots());
  if (layout.tree) t.recursion = TreeRecursion::of(layout.tree, system_, std::move(layout.fronts));
  t.coordinates = std::move(layout.tree);
  if (t.closure_rows.n_rows > 0) t.loops = LoopSizes(system_, modes);
  if (t.coordinates) lay_out_reactions(t), t.find_turns(system_);
  t.revision = system_.revision();
  return t;
}

Dynamics::Tree& Dynamics::Tree::of(const State& state) {
  if (state.coordinates == coordinates) return *this;
  throw ModelError(
      "the state has joint coordinates of another mechanism, or of other active joints; convert it first "
      "(Dynamics::to_slots)");
}

void Dynamics::Tree::find_turns(const System& system) {
  turns.clear(), n_angles = 0;
  motions.assign(system.n_slots() + 1, {});
  for (const auto& angle : system.counted_angles())
    if (const auto turn = angle->turn(); turn && turn->slot != turn->other) find_turn(*angle, *turn);
  if (!turns.empty()) n_angles = system.counted_angles().size();
}

// In a plane all slots rotate about its normal, in space two slots with one free axis about that: wherever the axis
// is fixed in both, with unit vectors a and b in their axes,
//
//     theta' = a . w_slot - b . w_other
//
// Across a hinge without laws theta is its coordinate, up to the sign and the value at its zero.
void Dynamics::Tree::find_turn(const CountedAngle& angle, const CountedAngle::Turn& turn) {
  const int slot = coordinates->node_of(turn.slot), other = coordinates->node_of(turn.other);
  const bool outward = slot > other;
  const TreeNode& n = coordinates->nodes()[outward ? slot : other];
  AxisInBoth own{static_cast<std::size_t>(angle.number()), turn.slot, turn.other, Vec3::Zero(), Vec3::Zero()};
  if (const int k = n.parent == (outward ? other : slot) ? axis_of(n) : -1; k >= 0) {
    own.a = rotation(n.far_q).col(k), own.b = rotation(n.near_q).col(k);
    if (n.turn == TreeTurn::hinge && !n.has_laws())
      own.q = n.first_q + n.n_slides, own.v = n.first_v + n.n_slides, own.sign = own.b.dot(n.axis) > 0 ? 1.0 : -1.0;
    if (!outward) std::swap(own.a, own.b), own.sign = -own.sign;
  } else if (const PlanarJoints* const plane = coordinates->planar()) {
    const auto normal = [&](int node) {
      return node < 0 ? Vec3(Vec3::Unit(plane->plane().n)) : plane->normal(plane->nodes()[node]);
    };
    own.a = normal(slot), own.b = normal(other);
  }
  if (!(own.b.squaredNorm() > 0) || !are_parallel(own.b, turn.axis)) return;
  if (own.b.dot(turn.axis) < 0) own.a = -own.a, own.b = -own.b, own.sign = -own.sign;
  if (own.q >= 0) {
    Motion& turned = motions[n.slot + 1];
    turned.e = n.K0, turned.A = rotation(n.K0);
    own.at_zero = angle.of_pose({.t = 0, .motions = motions, .s = {}, .z = {}});
    turned = {};
  }
  turns.push_back(own);
}

Inputs Dynamics::Tree::inputs(const State& state) {
  Inputs in;
  in.t = state.t, in.motions = motions;
  in.s = {state.s.data(), static_cast<std::size_t>(state.s.size())};
  in.z = {state.z.data(), static_cast<std::size_t>(state.z.size())};
  if (n_angles > 0) read_angles(state, in, angles, angle_rates);
  return in;
}

void Dynamics::Tree::read_angles(const State& state, Inputs& in, std::vector<double>& values,
                                 std::vector<double>& rates) const {
  values.assign(n_angles, NAN), rates.assign(n_angles, NAN);
  for (const AxisInBoth& turn : turns)
    if (turn.v >= 0)
      rates[turn.angle] = turn.sign * state.v[turn.v], values[turn.angle] = turn.sign * state.q[turn.q] + turn.at_zero;
    else
      rates[turn.angle] = turn.a.dot(in.slot(turn.slot).w) - turn.b.dot(in.slot(turn.other).w);
  in.angle_rates = rates, in.angles = values;
}

void Dynamics::Tree::outward(const State& y, std::vector<Motion>& out) {
  keeps = false;
  recursion->outward(y, out);
}

void Dynamics::Tree::outward_once(const State& y, const Inputs& of_kept) {
  if (keeps && y.t == kept.t && y.q == kept.q && y.v == kept.v && y.s == kept.s)
    motions.assign(of_kept.motions.begin(), of_kept.motions.end());
  else
    outward(y, motions);
}

void Dynamics::set_up() {
  system_.setup();
  if (tree_) tree_->keeps = false;  // a host may have changed laws
}

// Null if the state has other coordinates.
Dynamics::Tree* Dynamics::tree_of(const State& y) const {
  const bool is_current = y.coordinates && tree_ && tree_->coordinates == y.coordinates;
  return is_current && tree_->revision == system_.revision() ? tree_.get() : nullptr;
}

const Inputs& Dynamics::read(const State& state) {
  ++n_inputs_;
  if (tree_) tree_->keeps = false;
  Tree* const t = tree_of(state);
  if (t == nullptr) return inputs_.at(system_, state);
  return inputs_.at(
      state, [&](std::vector<Motion>& motions, Inputs& in, std::vector<double>& angles, std::vector<double>& rates) {
        t->outward(state, motions);
        in.motions = motions;
        if (t->n_angles > 0) t->read_angles(state, in, angles, rates);
        if (system_.control_inputs().empty()) t->keep(state);
      });
}

// The rows that are gathered in joint coordinates: all of them if accelerations or multipliers are read, those of
// links with laws if nothing but the power of laws is read.
void Dynamics::lay_out_reactions(Tree& t) const {
  bool any = false, power = false;
  t.reads_all = false;
  for (const auto& own : system_.auxiliaries()) {
    if (!own->reads_solution()) continue;
    (own->reads_law_power_alone() ? power : any) = true;
    t.reads_all = t.reads_all || !own->vanishes_without_laws();
  }
  std::vector<bool> shown = t.modes;
  if (!t.reads_all) shown.assign(t.modes.size(), false);
  bool laws = false;
  const auto show = [&](int link) { shown[link] = laws = true; };
  for (const TreeNode& n : t.coordinates->nodes())
    if (n.has_laws() || (n.left != 0 && may_have_laws(*n.lock))) show(n.link);
  for (const int link : t.coordinates->closures())
    if (may_have_laws(*system_.links()[link])) show(link);
  passes::lay_out(system_, shown, t.rows);
  t.solves = t.reads_all || (any && laws), t.reads_power = power && laws && !t.solves;
  if (t.solves) t.reactions.begin(*t.coordinates, system_, t.rows);
}

// Forces with those of the closures.
void Dynamics::load_closures(Tree& t) {
  t.loaded = t.f;
  if (!t.closures().empty()) subtract_reactions(t.closure_rows, t.closures().lambda(), t.loaded);
}

// Joints do no work along their free coordinates: what forces and closures leave of the power of inertia is that of laws,
//
//     P = V (M a - f + J' lambda) + lambda Ct = V (M a - f) + lambda (J V + Ct)
//
// with the rows of closures, which are gathered for the motion itself.
double Dynamics::joint_law_power(Tree& t) {
  double power = 0;
  for (int k = 0; k < system_.n_slots(); ++k) {
    const Slot& slot = system_.slot(k);
    const Motion& O = t.motions[k + 1];
    const Vec3 force = slot.mass * t.a.segment<3>(6 * k) - t.f.segment<3>(6 * k);
    const Vec3 moment = slot.J * t.a.segment<3>(6 * k + 3) - t.f.segment<3>(6 * k + 3);
    power += O.v.dot(force) + O.w.dot(moment);
  }
  if (t.closures().empty()) return power;
  find_residuals(t.closure_rows, t.motions, t.C, t.Cd);
  return power + t.closures().lambda().dot(t.Cd);
}

// Accelerations and multipliers for the states that are integrated. Where rows are redundant the multipliers of closures
// are not those of omega, which are the smallest of all: the sum of their power is the same.
void Dynamics::joint_reactions(Tree& t, const Inputs& in) {
  passes::gather_rows(system_, in, t.rows);
  load_closures(t);
  const ClosureRows& closures = t.closures();
  for (const RowEntry& e : t.rows.entries)
    if (const int at = closures.empty() ? -1 : t.closure_rows.entry_of_link[e.link]; at >= 0)
      t.reactions.set(e, t.closure_rows.entries[at], closures.lambda());
  t.reactions.solve(*t.coordinates, system_, t.motions, t.a, t.loaded, t.rows);
}

std::string Dynamics::why_not_joint(const std::vector<bool>& modes) { return tree(modes).why_not; }

void Dynamics::to_formulation(State& state, const State* near) {
  if (options_.formulation != Formulation::joint && options_.formulation != Formulation::automatic)
    return to_slots(state);
  check_state(system_, state);
  const std::shared_ptr<const JointTree> wanted = tree(state.modes).coordinates;
  if (state.coordinates == wanted) return;
  to_slots(state);
  if (!wanted) return;
  State out;
  wanted->read_off(state, near && near->coordinates == wanted ? near : nullptr, out);
  out.coordinates = wanted;
  state = std::move(out);
}

bool Dynamics::has_current_coordinates(const State& state) {
  return !state.coordinates || state.coordinates == tree(state.modes).coordinates;
}

void to_slot_coordinates(const System& system, State& state) {
  system.check_size(state);
  if (!state.coordinates) return;
  std::vector<Motion> motions;
  passes::motions(system, state, motions);
  // Made separately: if memory ends, Eigen's resize leaves a vector that points to freed memory.
  VecX q(7 * system.n_slots()), v(6 * system.n_slots());
  state.q = std::move(q), state.v = std::move(v);
  state.coordinates = nullptr;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Motion& O = motions[k + 1];
    state.set_slot_pose(k, {O.x, normalized(O.e)});
    state.set_slot_twist(k, {O.v, O.w});
  }
}

void Dynamics::to_slots(State& state) { to_slot_coordinates(system_, state); }

void Dynamics::rates(const State& state, StateRate& out) {
  if (state.coordinates)
    joint_rates(state, out, nullptr);
  else
    rate(state, out);
}

SolveReport Dynamics::rates_with_report(const State& state, StateRate& out) {
  if (!state.coordinates) return rate(state, out).full_report();
  SolveReport report;
  joint_rates(state, out, &report);
  return report;
}

// A tree without closures has no multipliers, so that its recursion is enough.
const VecX& Dynamics::accelerations(const State& state) {
  if (!state.coordinates || state.coordinates->has_rows()) return asked_a_ = solution_at(state).a;
  Tree& t = tree(state.modes).of(state);
  system_.check_size(state);
  t.outward_once(state, inputs_.get());
  const Inputs in = t.inputs(state);
  passes::gather_forces(system_, in, t.f);
  t.recursion->accelerate(t.motions, t.f, t.correction);
  if (t.coordinates->n_v() == 0) t.recursion->follow();
  t.recursion->accelerations(t.motions, asked_a_);
  ++work_.evaluations;
  if (!asked_a_.allFinite()) gather(state);  // names the object at fault
  return asked_a_;
}

void Dynamics::joint_rates(const State& state, StateRate& out, SolveReport* report) {
  Tree& t = tree(state.modes).of(state);
  system_.check_size(state);
  ClosureRows& rows = t.closures();
  const bool closed = !rows.empty();
  if (closed && rows.redundant() == Kkt::kUnknown) rows.set_redundant(redundancy(state).rows);
  t.outward_once(state, inputs_.get());
  const Inputs in = t.inputs(state);
  const bool driven = t.coordinates->n_v() == 0;
  passes::gather_forces(system_, in, t.f);  // and reports errors in them, even if they move nothing
  const Solution* solved = nullptr;
  t.multipliers_known = true;
  if (driven)
    t.recursion->follow(), out.v.resize(0);
  else if (!closed)
    t.recursion->accelerate(t.motions, t.f, out.v);
  else
    solved = joint_accelerations(t, state, in, out, report);
  out.largest_a = t.recursion->largest().a(), out.largest_alpha = t.recursion->largest().alpha();
  t.coordinates->kinematic_rate(state, out.q);
  if (out.followed.size() > 0 || t.solves || t.reads_power) t.recursion->accelerations(t.motions, t.a);
  write_followed(t.coordinates->followed(), t.motions, t.a, out.followed);
  out.s.resize(state.s.size());
  if (state.s.size() > 0) {
    if ((t.solves || t.reads_power) &&
        (solved || !t.multipliers_known || (t.reads_all && t.coordinates->may_be_redundant()))) {
      if (!solved) solved = &evaluate(state), --work_.evaluations;
      passes::state_rates(system_, *solved, out.s);
    } else if (t.solves) {
      joint_reactions(t, in);
      passes::state_rates(system_, {in, t.a, t.reactions.lambda(), t.rows}, out.s);
    } else {
      passes::state_rates(system_, {in, t.none, t.none, t.rows, t.reads_power ? joint_law_power(t) : 0.0}, out.s);
    }
    if (!out.s.allFinite()) diagnose_rates(system_, state.t, out.s);
  }
  ++work_.evaluations;
  if (out.v.allFinite() && out.followed.allFinite() && (!driven || t.f.allFinite()))
    return;       // what laws move does not feel its forces
  gather(state);  // names the object at fault
  throw NonFiniteError("t = " + text::number(state.t) +
                           " s: the accelerations are not finite, but all forces are: the motion diverged; "
                           "take a smaller step (--step) or tolerance",
                       {.thing = {.kind = "mechanism"}, .t = state.t});
}

// With closures. Where their rows cannot be met, and not for redundant ones off the constraints alone, omega answers, and
// names what contradicts what; its solution is then returned.
const Solution* Dynamics::joint_accelerations(Tree& t, const State& state, const Inputs& in, StateRate& out,
                                              SolveReport* report) {
  TreeRecursion& recursion = *t.recursion;
  ClosureRows& closures = t.closures();
  passes::gather_rows(system_, in, t.closure_rows);
  recursion.read(t.motions, t.closure_rows);
  if (const Stabilization& s = options_.stabilization; s.kind == Stabilization::Kind::baumgarte) {
    find_residuals(t.closure_rows, t.motions, t.C, t.Cd);
    t.correction = 2.0 * s.alpha * t.Cd + s.beta * s.beta * t.C;
    closures.subtract(t.correction);
  }
  recursion.accelerate(t.motions, t.f, out.v);
  bool met = recursion.met(false);
  double before = HUGE_VAL;
  while (!met && closures.residual() < kStalledRows * before) {
    before = closures.residual();
    recursion.correct(out.v);
    met = recursion.met(true);
    ++work_.corrections;
  }
  if (report) closures.complete(*report);
  t.multipliers_known = met;
  if (met || closures.is_left_by_redundant_rows(before)) return nullptr;
  const Solution& omega = evaluate(state);
  --work_.evaluations;
  recursion.read_off(t.motions, omega.a, out.v);
  if (report) report->residual = omega.full_report().residual;
  return &omega;
}

}  // namespace lockstep
