#include "framework/tools/batch/lane_plan.h"

#include <map>
#include <typeinfo>

#include "framework/mechanism/links/joints.h"

namespace lockstep::lanes {
namespace {

// Classes that are a mask and nothing else: what one of another's own adds would not be seen.
template <class... Joints>
bool is_any_of(const Lock& link) {
  return ((typeid(link) == typeid(Joints)) || ...);
}
const MarkerLock* plain_lock(const Lock& link) {
  const bool known = is_any_of<Fixed, PointOnLine, PointOnPlane, PlaneOnPlane, Revolute, Cylindrical, AngularAlignment,
                               Oldham, Prismatic, Rzeppa, Homokinetic, Spherical, GenericLock>(link);
  return known ? static_cast<const MarkerLock*>(&link) : nullptr;
}

bool law_on(const Marker& m) { return m.slide || m.spin; }
const char* law_word(const Marker& m) { return m.slide ? "slides" : "spins"; }

RowTable rows_of(const System& system) {
  std::vector<bool> modes;
  for (const auto& link : system.links()) modes.push_back(link->active_at_start());
  RowTable table;
  system.lay_out(modes, table);
  return table;
}

std::string unsuited_link(const Lock& link) {
  const std::string who = "link '" + link.name() + "' ";
  const MarkerLock* lock = plain_lock(link);
  if (!lock)
    return who + "(" + std::string(link.type()) +
           ") is no lock of markers alone; only joints that are a mask run in lanes";
  for (const Marker* m : {&lock->p(), &lock->s()})
    if (law_on(*m)) return who + "has the marker '" + m->name + "', which " + law_word(*m) + " by a law of its own";
  const int P = lock->p().body->slot, S = lock->s().body->slot;
  if (P == S) return who + "joins two bodies that move as one";
  return "";
}

}  // namespace

std::string unsuited(const System& system) {
  if (system.plane()) return "the system is planar (three velocities a body); lanes work in space, take \"planar\" out";
  if (!system.auxiliaries().empty())
    return "'" + system.auxiliaries().front()->name() + "' integrates states of its own (an auxiliary)";
  if (system.n_slots() == 0) return "nothing moves";
  for (const auto& force : system.forces())
    if (force->reacting() != nullptr)
      return "force '" + force->name() + "' (" + std::string(force->type()) + ") reads the reactions of links";
  for (const auto& link : system.links())
    if (link->unilateral()) return "link '" + link->name() + "' is one-sided, and lanes know no impacts";
  const RowTable rows = rows_of(system);
  for (const RowEntry& e : rows.entries)
    if (const std::string why = unsuited_link(*system.links()[static_cast<std::size_t>(e.link)]); !why.empty())
      return why;
  std::vector<int> links(static_cast<std::size_t>(system.n_slots()));
  for (const RowEntry& e : rows.entries)
    for (int i = 0; i < e.slots.n; ++i)
      if (++links[static_cast<std::size_t>(e.slots[i])] > schur::Plan::kHub)
        return "body '" + system.body_of_slot(e.slots[i]).name + "' carries more than " +
               std::to_string(schur::Plan::kHub) + " links";
  return "";
}

namespace {

Turn turn_of(const MarkerLock& lock) {
  if (!any(lock.rows(), Mask::e123)) return Turn::none;
  if (lock.laws() & with::qD) return Turn::law;
  return lock.laws() & with::parallel ? Turn::parallel : Turn::plain;
}

Node node_of(const schur::Node& from, const RowEntry& e, const MarkerLock& lock, Plan& plan) {
  Node node;
  node.m = from.m;
  node.triple = e.layout == RowLayout::triple;
  node.moved = lock.laws() & with::p;
  node.turn = turn_of(lock);
  for (int k = 0, next = 0; k < 6; ++k)
    if (has(lock.rows(), row_bit(k))) node.row[static_cast<std::size_t>(next++)] = k;
  for (std::size_t k = 0; k < static_cast<std::size_t>(node.m); ++k) node.kind[k] = e.kind[k];
  const int P = lock.p().body->slot, S = lock.s().body->slot;
  node.P = P == kGround ? plan.n_slots : P, node.S = S == kGround ? plan.n_slots : S;
  node.first_side = from.first_side, node.n_sides = from.n_sides;
  for (int i = 0; i < from.n_sides; ++i) {
    const int slot = e.slots[i];
    Side side{slot, e.shape().sign_of(i), node.triple, plan.size_J, plan.size_Y};
    const auto n = static_cast<std::size_t>((node.triple ? 3 : 6) * node.m);
    plan.size_J += n, plan.size_Y += n;
    (slot == P ? node.side_P : node.side_S) = from.first_side + i;
    plan.sides.push_back(side);
  }
  node.frames = plan.size_frames;
  plan.size_frames += frames::size;
  node.law = plan.size_law;
  if (node.moved || node.turn == Turn::law) plan.size_law += law::size;
  node.x = plan.size_x;
  plan.size_x += static_cast<std::size_t>(node.m);
  return node;
}

}  // namespace

Plan make_plan(const System& system) {
  const RowTable rows = rows_of(system);
  const schur::Plan from = schur::make_plan(rows, system.n_slots(), false);
  Plan plan;
  plan.n_slots = system.n_slots(), plan.n_states = system.n_states();
  plan.tree = from.tree;
  plan.terms = from.terms;
  for (const schur::Node& n : from.nodes) {
    const RowEntry& e = rows.entries[static_cast<std::size_t>(n.link)];
    plan.link.push_back(e.link);
    plan.nodes.push_back(
        node_of(n, e, static_cast<const MarkerLock&>(*system.links()[static_cast<std::size_t>(e.link)]), plan));
  }
  // The blocks of the factor keep their order, in packs.
  std::map<std::size_t, std::size_t> place;
  for (std::size_t k = 0; k < plan.nodes.size(); ++k) {
    const schur::Node& n = from.nodes[k];
    Node& node = plan.nodes[k];
    const auto m = static_cast<std::size_t>(node.m);
    node.D = place[n.D] = plan.size_A;
    plan.size_A += m * (m + 1) / 2;
    node.first_later = n.first_later, node.n_later = n.n_later, node.first_target = n.first_target;
    for (int s = 0; s < n.n_later; ++s) {
      const schur::Later& l = from.later[static_cast<std::size_t>(n.first_later + s)];
      place[l.block] = plan.size_A;
      plan.later.push_back(
          {l.node, l.m, plan.nodes[static_cast<std::size_t>(l.node)].x, plan.size_A, l.first_term, l.n_terms});
      plan.size_A += m * static_cast<std::size_t>(l.m);
    }
  }
  for (const std::size_t t : from.targets) plan.targets.push_back(place.at(t));
  return plan;
}

}  // namespace lockstep::lanes
