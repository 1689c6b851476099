// The coordinates of a state: conversions, and the rates in joint coordinates.
#include <lockstep/dynamics.h>

#include <algorithm>

#include <lockstep/error.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/joint_coordinates.h"
#include "framework/mechanism/system/diagnose.h"

namespace lockstep {

Dynamics::~Dynamics() = default;

Dynamics::Tree& Dynamics::tree(const std::vector<bool>& modes) {
  system_.setup();
  if (modes.size() != system_.links().size())
    throw ModelError("a state of " + std::to_string(modes.size()) + " links does not fit the system, which has " +
                     std::to_string(system_.links().size()) +
                     " since it was changed; take a new one from System::start");
  if (!tree_) tree_ = std::make_unique<Tree>();
  Tree& t = *tree_;
  if (t.revision == system_.revision() && t.modes == modes) return t;
  t.revision = system_.revision(), t.modes = modes;
  t.coordinates = JointTree::of(system_, modes, t.why_not);
  if (t.coordinates) t.bodies.begin(*t.coordinates, system_);
  t.f.setZero(6 * system_.n_slots());
  if (t.coordinates) lay_out_reactions(t);
  return t;
}

// The rows that are gathered in joint coordinates: all of them if somebody reads accelerations or multipliers, those of
// links with laws if nothing but the power of laws is read.
void Dynamics::lay_out_reactions(Tree& t) const {
  bool any = false, every = false;
  for (const auto& own : system_.auxiliaries()) {
    any = any || own->reads_solution();
    every = every || (own->reads_solution() && !own->vanishes_without_laws());
  }
  std::vector<bool> shown = t.modes;
  if (!every) shown.assign(t.modes.size(), false);
  for (const TreeNode& n : t.coordinates->nodes())
    if (n.imposed) shown[static_cast<std::size_t>(n.link)] = true;
  system_.lay_out(shown, t.rows);
  t.solves = every || (any && t.coordinates->has_laws());
  if (t.solves) t.reactions.begin(*t.coordinates, system_, t.rows);
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

bool Dynamics::has_current_coordinates(const State& state) {
  return !state.coordinates || state.coordinates == tree(state.modes).coordinates;
}

void Dynamics::to_slots(State& state) {
  if (!state.coordinates) return;
  std::vector<Motion> motions;
  system_.motions(state, motions);
  // Made beside: where memory ends, Eigen's resize leaves a vector that points to what it has freed.
  VecX q(7 * system_.n_slots()), v(6 * system_.n_slots());
  state.q = std::move(q), state.v = std::move(v);
  state.coordinates = nullptr;
  for (int k = 0; k < system_.n_slots(); ++k) {
    const Motion& O = motions[static_cast<std::size_t>(k + 1)];
    state.set_slot_pose(k, {O.x, normalized(O.e)});
    state.set_slot_twist(k, {O.v, O.w});
  }
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
    if (t.solves) {
      system_.gather_rows(in, t.rows);
      t.reactions.solve(*t.coordinates, system_, t.motions, t.bodies, t.f, t.rows);
      system_.state_rates({in, t.reactions.a(), t.reactions.lambda(), t.rows}, out.s);
    } else {
      system_.state_rates({in, t.none, t.none, t.rows}, out.s);
    }
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

}  // namespace lockstep
